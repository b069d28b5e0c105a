// A client that was made from the server's own description of its HTTP resources: types by openapi-typescript, calls by openapi-fetch.
import assert from "node:assert/strict";
import { type ChildProcessByStdio, spawn } from "node:child_process";
import { once } from "node:events";
import { after, before, describe, it } from "node:test";
import type { Readable } from "node:stream";

import createClient, { type Client } from "openapi-fetch";

import type { paths } from "./schema.js";

const POINTS = 500;

let server: ChildProcessByStdio<null, Readable, null>;
let client: Client<paths>;
let session = "";
let meshId = "";

/** An octahedron whose faces are divided into four, so many times, on the unit sphere, as an OFF file. */
function sphere(times: number): string {
  let faces = [
    [1, 2, 3],
    [1, 3, -2],
    [1, -2, -3],
    [1, -3, 2],
    [-1, 3, 2],
    [-1, -2, 3],
    [-1, -3, -2],
    [-1, 2, -3],
  ].map((face) => face.map((axis) => [0, 1, 2].map((k) => (k === Math.abs(axis) - 1 ? Math.sign(axis) : 0))));
  const middle = (a: number[], b: number[]) => {
    const sum = a.map((x, k) => x + b[k]!);
    const length = Math.hypot(...sum);
    return sum.map((x) => x / length);
  };
  for (let i = 0; i < times; ++i) {
    faces = faces.flatMap(([a, b, c]) => {
      const [ab, bc, ca] = [middle(a!, b!), middle(b!, c!), middle(c!, a!)];
      return [
        [a!, ab, ca],
        [ab, b!, bc],
        [ca, bc, c!],
        [ab, bc, ca],
      ];
    });
  }
  const indices = new Map<string, number>();
  const vertices: string[] = [];
  const lines = faces.map((face) => {
    const corners = face.map((p) => {
      const line = p.map((x) => x.toFixed(9)).join(" ");
      if (!indices.has(line)) {
        indices.set(line, vertices.length);
        vertices.push(line);
      }
      return indices.get(line)!;
    });
    return `3 ${corners.join(" ")}`;
  });
  return `OFF\n${vertices.length} ${lines.length} 0\n${vertices.join("\n")}\n${lines.join("\n")}\n`;
}

describe("a client from the description", () => {
  before(async () => {
    const arguments_ = ["--pdeathsig", "TERM", process.env.CURVECAST_COMMAND!, "serve", "--quiet"];
    arguments_.push("--listen", "127.0.0.1:0", "--http", "127.0.0.1:0");
    server = spawn("setpriv", arguments_, { stdio: ["ignore", "pipe", "inherit"] });
    let text = "";
    while (!/http on (\S+)/.test(text)) text += (await once(server.stdout, "data"))[0];
    client = createClient<paths>({ baseUrl: `http://${/http on (\S+)/.exec(text)![1]}` });
  });

  after(() => {
    server.kill("SIGTERM");
  });

  it("uploads a mesh and makes a session", async () => {
    const { data: mesh, error } = await client.PUT("/v1/meshes/{mesh}", {
      params: { path: { mesh: "sphere.off" } },
      headers: { "Content-Type": "application/octet-stream" },
      body: sphere(4),
      bodySerializer: (body) => body,
    });
    assert.ok(mesh, JSON.stringify(error));
    assert.equal(mesh.mesh?.faces, "2048");
    meshId = mesh.meshId;
    const found = await client.GET("/v1/meshes/{mesh}", { params: { path: { mesh: mesh.meshId } } });
    assert.equal(found.data?.name, "sphere.off");
    const made = await client.POST("/v1/sessions", { body: { meshId: mesh.meshId, options: { maxPoints: "2000" } } });
    assert.ok(made.data, JSON.stringify(made.error));
    assert.equal(made.data.state, "SESSION_STATE_READY");
    session = made.data.sessionId;
    const list = await client.GET("/v1/sessions", { params: { query: { page_size: 10 } } });
    assert.deepEqual(
      list.data?.sessions.map((one) => one.sessionId),
      [session],
    );
  });

  it("lists what it has uploaded, and uploads what has no length yet", async () => {
    const streamed = await client.PUT("/v1/meshes/{mesh}", {
      params: { path: { mesh: "streamed.off" } },
      headers: { "Content-Type": "application/octet-stream" },
      body: sphere(3),
      bodySerializer: (body) => new Blob([body]).stream(),
      duplex: "half",
    });
    assert.ok(streamed.data, JSON.stringify(streamed.error));
    assert.equal(streamed.data.size, String(sphere(3).length));
    const ids: string[] = [];
    let token = "";
    do {
      const { data, error } = await client.GET("/v1/meshes", { params: { query: { page_size: 1, page_token: token } } });
      assert.ok(data, JSON.stringify(error));
      ids.push(...data.meshes.map((mesh) => mesh.meshId));
      token = data.nextPageToken;
    } while (token !== "");
    assert.equal(ids.length, 2);
    assert.ok(ids.includes(streamed.data.meshId));
  });

  it("takes points", async () => {
    const query = { n: POINTS, density: ["curvature:floor=0.2", "expression:z > -2"], attributes: ["curvatures" as const] };
    const { data, error } = await client.GET("/v1/sessions/{session}/points.json", { params: { path: { session }, query } });
    assert.ok(data, JSON.stringify(error));
    assert.equal(data.count, POINTS);
    assert.equal(data.positions?.length, 3 * POINTS);
    assert.equal(data.curvatures?.length, 2 * POINTS);
    for (let i = 0; i < POINTS; ++i) {
      const point = [0, 1, 2].map((axis) => data.positions![3 * i + axis]! + data.origin[axis]!);
      const distance = Math.hypot(...point);
      assert.ok(distance > 0.98 && distance < 1.0001, `point ${i} is ${distance} from the middle`);
    }
  });

  it("takes points of a mesh without a session", async () => {
    const query = { n: POINTS, relax: 1, crease: 30, attributes: ["surface" as const] };
    const { data, error } = await client.GET("/v1/meshes/{mesh}/points.json", { params: { path: { mesh: meshId }, query } });
    assert.ok(data, JSON.stringify(error));
    assert.equal(data.count, POINTS);
    assert.equal(data.faces?.length, POINTS);
    for (let i = 0; i < POINTS; ++i) {
      const distance = Math.hypot(...[0, 1, 2].map((axis) => data.positions![3 * i + axis]! + data.origin[axis]!));
      assert.ok(distance > 0.98 && distance < 1.0001, `point ${i} is ${distance} from the middle`);
    }
  });

  it("takes a file and a picture, once", async () => {
    const ply = await client.GET("/v1/sessions/{session}/points.ply", {
      params: { path: { session }, query: { n: POINTS } },
      parseAs: "arrayBuffer",
    });
    assert.ok(ply.data, JSON.stringify(ply.error));
    assert.match(Buffer.from(ply.data).toString("latin1", 0, 80), /^ply\nformat binary_little_endian 1.0\nelement vertex 500\n/);
    const again = await client.GET("/v1/sessions/{session}/points.ply", {
      params: { path: { session }, query: { n: POINTS }, header: { "If-None-Match": ply.response.headers.get("ETag")! } },
      parseAs: "stream",
    });
    assert.equal(again.response.status, 304);
    const picture = await client.GET("/v1/sessions/{session}/picture.png", {
      params: { path: { session }, query: { width: 80, height: 60, camera: "eye=0,0,4", what: "shaded" } },
      parseAs: "arrayBuffer",
    });
    assert.ok(picture.data, JSON.stringify(picture.error));
    const png = Buffer.from(picture.data);
    assert.equal(png.toString("latin1", 1, 4), "PNG");
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [80, 60]);
  });

  it("takes tiles", async () => {
    const query = { n: POINTS, density: ["curvature:floor=0.2"] };
    const { data, error } = await client.GET("/v1/sessions/{session}/tileset.json", { params: { path: { session }, query } });
    assert.ok(data, JSON.stringify(error));
    assert.equal(data.asset.version, "1.1");
    const [, set, file] = data.root.content!.uri.split("/");
    const tile = await client.GET("/v1/sessions/{session}/tiles/{set}/{file}", {
      params: { path: { session, set: set!, file: file! } },
      parseAs: "arrayBuffer",
    });
    assert.ok(tile.data, JSON.stringify(tile.error));
    assert.equal(Buffer.from(tile.data as ArrayBuffer).toString("latin1", 0, 4), "glTF");
    assert.match(tile.response.headers.get("Cache-Control")!, /immutable/);
  });

  it("is told what is wrong", async () => {
    const { error, response } = await client.GET("/v1/sessions/{session}/points.ply", {
      params: { path: { session }, query: { n: 0 } },
    });
    assert.equal(response.status, 400);
    assert.equal(error?.code, 3);
    assert.equal(error?.details[0]?.fieldViolations?.[0]?.field, "sample.points");
    const closed = await client.DELETE("/v1/sessions/{session}", { params: { path: { session } } });
    assert.equal(closed.response.status, 204);
    const gone = await client.GET("/v1/sessions/{session}", { params: { path: { session } } });
    assert.equal(gone.error?.code, 5);
  });
});
