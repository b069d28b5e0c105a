// A client in a language that the project gives no client for: all it has is the .proto file, read at run time, and gRPC.
"use strict";

const assert = require("node:assert/strict");
const { spawn } = require("node:child_process");
const { once } = require("node:events");
const path = require("node:path");
const { after, before, describe, it } = require("node:test");

const SKIPPED = 77; // what CTest takes for a skipped test
let grpc, protoLoader;
try {
  grpc = require("@grpc/grpc-js");
  protoLoader = require("@grpc/proto-loader");
} catch (error) {
  console.log(`skipped: ${error.message.split("\n")[0]}; deploy/test installs the packages`);
  process.exit(SKIPPED);
}

// Of grpc.reflection.v1alpha, what listing services takes.
const REFLECTION = {
  nested: {
    grpc: {
      nested: {
        reflection: {
          nested: {
            v1alpha: {
              nested: {
                ServerReflection: {
                  methods: {
                    ServerReflectionInfo: {
                      requestType: "Request",
                      requestStream: true,
                      responseType: "Response",
                      responseStream: true,
                    },
                  },
                },
                Request: { fields: { list_services: { type: "string", id: 7 } } },
                Response: { fields: { list_services_response: { type: "ServiceList", id: 6 } } },
                ServiceList: { fields: { service: { rule: "repeated", type: "Service", id: 1 } } },
                Service: { fields: { name: { type: "string", id: 1 } } },
              },
            },
          },
        },
      },
    },
  },
};
const OPTIONS = { keepCase: true, longs: Number, enums: String, defaults: true, oneofs: true };
const PROTO = path.join(process.env.CURVECAST_SOURCE, "proto");

let server, address, client;

/** The answer of a call that sends one message and takes one. */
function ask(method, request) {
  return new Promise((resolve, reject) => {
    client[method](request, (error, response) => (error ? reject(error) : resolve(response)));
  });
}

/** All messages of an answer. */
async function askAll(method, request) {
  const messages = [];
  for await (const message of client[method](request)) messages.push(message);
  return messages;
}

function upload(name, bytes) {
  return new Promise((resolve, reject) => {
    const call = client.UploadMesh((error, response) => (error ? reject(error) : resolve(response)));
    call.write({ header: { name, size: bytes.length } });
    for (let at = 0; at < bytes.length; at += 1000) call.write({ chunk: bytes.subarray(at, at + 1000) });
    call.end();
  });
}

/** A sphere of `rings` x 2 `rings` quads with its poles, as an OBJ file. */
function sphere(rings) {
  const columns = 2 * rings;
  const lines = [];
  for (let r = 0; r <= rings; ++r) {
    for (let c = 0; c < (r % rings ? columns : 1); ++c) {
      const theta = (Math.PI * r) / rings,
        phi = (2 * Math.PI * c) / columns;
      lines.push(`v ${Math.sin(theta) * Math.cos(phi)} ${Math.cos(theta)} ${Math.sin(theta) * Math.sin(phi)}`);
    }
  }
  const index = (r, c) => (r === 0 ? 1 : r === rings ? 2 + (rings - 1) * columns : 2 + (r - 1) * columns + (c % columns));
  for (let r = 0; r < rings; ++r) {
    for (let c = 0; c < columns; ++c) {
      lines.push(`f ${[...new Set([index(r, c), index(r, c + 1), index(r + 1, c + 1), index(r + 1, c)])].join(" ")}`);
    }
  }
  return Buffer.from(lines.join("\n") + "\n");
}

async function openSphere(points) {
  const { mesh_id } = await upload("sphere.obj", sphere(24));
  const messages = await askAll("CreateSession", { mesh_id, options: { max_points: points } });
  return messages.at(-1).session;
}

/** How far from the origin the points of a raw block are, at least and at most. */
function reach(block) {
  const { positions, normals, radii } = block.raw;
  assert.equal(positions.length, 12 * block.count);
  assert.equal(normals.length, 12 * block.count);
  assert.equal(radii.length, 4 * block.count);
  let low = Infinity,
    high = 0;
  for (let i = 0; i < block.count; ++i) {
    const distance = Math.hypot(
      ...[0, 1, 2].map((axis) => positions.readFloatLE(12 * i + 4 * axis) + (block.origin ? block.origin["xyz"[axis]] : 0)),
    );
    low = Math.min(low, distance);
    high = Math.max(high, distance);
  }
  return [low, high];
}

describe("the API from its .proto file alone", () => {
  before(async () => {
    // The kernel ends the server should this process die.
    server = spawn(
      "setpriv",
      ["--pdeathsig", "TERM", process.env.CURVECAST_COMMAND, "serve", "--listen", "127.0.0.1:0", "--quiet"],
      { stdio: ["ignore", "pipe", "inherit"] },
    );
    const [line] = await once(server.stdout, "data");
    address = /listening on (\S+)/.exec(line.toString())[1];
    const definition = protoLoader.loadSync("curvecast/v1/curvecast.proto", { ...OPTIONS, includeDirs: [PROTO] });
    const { CurvecastService } = grpc.loadPackageDefinition(definition).curvecast.v1;
    client = new CurvecastService(address, grpc.credentials.createInsecure(), { "grpc.max_receive_message_length": 64 << 20 });
  });

  after(async () => {
    client.close();
    server.kill("SIGTERM");
    const [status] = await once(server, "exit");
    assert.equal(status, 0);
  });

  it("the server says which services it has", async () => {
    const { ServerReflection } = grpc.loadPackageDefinition(protoLoader.fromJSON(REFLECTION, OPTIONS)).grpc.reflection.v1alpha;
    const reflection = new ServerReflection(address, grpc.credentials.createInsecure());
    const call = reflection.ServerReflectionInfo();
    call.write({ list_services: "" });
    call.end();
    const [response] = await once(call, "data");
    call.resume();
    reflection.close();
    const names = response.list_services_response.service.map((service) => service.name);
    assert.ok(names.includes("curvecast.v1.CurvecastService"), names.join());
    assert.ok(names.includes("grpc.health.v1.Health"), names.join());
  });

  it("a mesh, a session, a point set", async () => {
    const bytes = sphere(24);
    const { mesh_id, size } = await upload("sphere.obj", bytes);
    assert.equal(size, bytes.length);
    assert.equal((await ask("GetMesh", { mesh_id })).name, "sphere.obj");
    const messages = await askAll("CreateSession", { mesh_id, options: { max_points: 5000 } });
    const { session } = messages.at(-1);
    assert.equal(session.state, "SESSION_STATE_READY");
    assert.equal(session.report.mesh.genus, 0);
    const answer = await askAll("Resample", { session_id: session.session_id, sample: { points: 5000, encoding: { raw: {} } } });
    let count = 0;
    for (const { points } of answer) {
      const [low, high] = reach(points);
      assert.ok(low > 0.98 && high < 1.00001, `${low} to ${high}`);
      count += points.count;
    }
    assert.equal(count, 5000);
    assert.ok(answer.at(-1).statistics.curve_vertices > 5000);
  });

  it("errors are codes and messages", async () => {
    const nothing = "0".repeat(32);
    await assert.rejects(ask("GetMesh", { mesh_id: nothing }), { code: grpc.status.NOT_FOUND });
    const { session_id } = await openSphere(1000);
    await assert.rejects(askAll("Resample", { session_id, sample: { points: 0 } }), { code: grpc.status.INVALID_ARGUMENT });
  });

  it("a conversation of two views", async () => {
    const { session_id } = await openSphere(2000);
    const call = client.StreamViews();
    const frames = call[Symbol.asyncIterator]();
    call.write({ open: { session_id } });
    for (const sequence of [1, 2]) {
      const camera = { eye: { x: sequence, y: 0.5, z: 3 }, target: { x: 0, y: 0, z: 0 } };
      const sample = { points: 2000, density: [{ view: {} }], cameras: [camera], encoding: { raw: {} } };
      call.write({ view: { sequence, sample } });
      for (let refining = true; refining;) {
        const { frame } = (await frames.next()).value;
        call.write({ ack: { sequence: frame.sequence } });
        assert.equal(frame.error, null);
        assert.equal(frame.sequence, sequence);
        assert.equal(frame.kind, "FRAME_KIND_KEY");
        const blocks = [frame.points].flat();
        assert.equal(
          blocks.reduce((sum, block) => sum + block.count, 0),
          2000,
        );
        for (const block of blocks) assert.ok(reach(block)[0] > 0.98);
        ({ refining } = frame.statistics);
      }
    }
    call.end();
    assert.equal((await frames.next()).done, true);
  });
});
