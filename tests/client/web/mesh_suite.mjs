// The wireframe: a mesh of the surface that follows the density, also while it is painted.

import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, afterEach, before, describe, it } from "node:test";

import { WatchedPage } from "./support/browser.mjs";
import { tetrahedra } from "./support/meshes.mjs";
import { difference } from "./support/pictures.mjs";
import { Server, temporaryFolder } from "./support/server.mjs";
import { openTorus } from "./support/shared_server.mjs";

const vertices = 500; // edges of about 20 pixels

/// The mesh as plain values.
const meshOf = ({ mesh }) => ({
  positions: [...mesh.vertices.order()].map((slot) =>
    mesh.vertices.origin.map((value, k) => value + mesh.vertices.positions[4 * slot + k]),
  ),
  triangles: [...mesh.triangles],
});

/// The middle of each edge in pixels of the picture, and the cosine between the mesh's normal there and the direction to the eye.
const edgesOf = ({ mesh, view }) => {
  const { eye, target, up, fov } = view.camera;
  const minus = (a, b) => a.map((value, k) => value - b[k]);
  const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((value) => value / Math.hypot(...a));
  const forward = unit(minus(target, eye));
  const right = unit(cross(forward, up));
  const top = cross(right, forward);
  const { width, height } = view.size;
  const scale = height / 2 / Math.tan((fov * Math.PI) / 360);
  const { positions, normals, origin } = mesh.vertices;
  const at = (column, v) => [0, 1, 2].map((k) => column[4 * v + k]);
  const edges = [];
  for (let i = 0; i < mesh.triangles.length; ++i) {
    const [a, b] = [mesh.triangles[i], mesh.triangles[i % 3 === 2 ? i - 2 : i + 1]];
    if (a > b) continue;
    const middle = at(positions, a).map((value, k) => (value + positions[4 * b + k]) / 2 + origin[k]);
    const away = minus(middle, eye);
    const depth = dot(away, forward);
    edges.push({
      x: width / 2 + (scale * dot(away, right)) / depth,
      y: height / 2 - (scale * dot(away, top)) / depth,
      facing: -dot(unit(at(normals, a).map((value, k) => value + normals[4 * b + k])), unit(away)),
    });
  }
  return edges;
};

const countWithin = (positions, { centre, radius }) =>
  positions.filter((place) => Math.hypot(...place.map((value, k) => value - centre[k])) < radius).length;

/// How often each edge is used in each direction.
function edgeUses(triangles) {
  const uses = new Map();
  triangles.forEach((a, i) => {
    const b = triangles[i % 3 === 2 ? i - 2 : i + 1];
    uses.set(`${a} ${b}`, (uses.get(`${a} ${b}`) ?? 0) + 1);
  });
  return uses;
}

describe("the wireframe", () => {
  let torus;
  before(async () => (torus = await openTorus("points=5000")));
  afterEach(() => torus.assertFine());
  after(() => torus.close());

  const meshed = () => torus.until((c) => c.mesh !== null && c.isMeshCurrent);

  it("is that of a closed mesh with as many vertices as wanted, on the surface", async () => {
    await torus.set("vertices", vertices);
    await torus.page.keyboard.press("t");
    await meshed();
    const { positions, triangles } = await torus.evaluate(meshOf);
    assert.equal(positions.length, vertices);
    assert.equal(triangles.length, 3 * 2 * vertices, "a torus has twice as many triangles");
    const uses = edgeUses(triangles);
    for (const [edge, count] of uses) {
      assert.equal(count, 1);
      assert.ok(uses.has(edge.split(" ").reverse().join(" ")), "each edge has two sides");
    }
    for (const [x, y, z] of positions) {
      const around = Math.hypot(Math.hypot(x, y) - 1, z); // from the middle of the torus's tube
      assert.ok(around > 0.3 && around < 0.5);
    }
    await torus.page.locator(".hud dd.mesh", { hasText: /^500 vertices in / }).waitFor(); // a moment later
  });

  it("is drawn where the mesh faces the eye, and hidden where it does not", async () => {
    const drawn = await torus.picture("wireframe.png");
    const edges = await torus.evaluate(edgesOf);
    await torus.page.keyboard.press("t");
    await torus.until((c) => c.mesh === null);
    const inked = difference(drawn, await torus.picture(), 30);
    await torus.page.keyboard.press("t");
    await meshed();
    const share = (some) => some.filter(({ x, y }) => inked[Math.floor(y) * drawn.width + Math.floor(x)]).length / some.length;
    const front = share(edges.filter(({ facing }) => facing > 0.4));
    const back = share(edges.filter(({ facing }) => facing < -0.4));
    assert.ok(front > 0.7 && back < 0.4, `${front} of the edges in front are drawn, and ${back} of those behind`);
  });

  it("stays while the picture turns, unless the camera's density is wanted, too", async () => {
    const turn = () =>
      torus.change(() =>
        torus.drag([
          [320, 20],
          [360, 40],
        ]),
      );
    await torus.evaluate((c) => void (window.meshBefore = c.mesh));
    await turn();
    await torus.settled();
    assert.ok(await torus.evaluate((c) => c.isMeshCurrent && c.mesh === window.meshBefore));
    await torus.set("dense for this view", true);
    await torus.until((c) => c.mesh !== window.meshBefore && c.isMeshCurrent);
    await torus.evaluate((c) => void (window.meshBefore = c.mesh));
    await turn();
    await torus.until((c) => c.mesh !== window.meshBefore && c.isMeshCurrent);
    await torus.evaluate((c) => void (window.meshBefore = c.mesh));
    await torus.set("dense for this view", false);
    await torus.page.keyboard.press("f");
    await torus.until((c) => c.mesh !== window.meshBefore && c.isMeshCurrent);
  });

  it("grows denser under the brush while it paints, and is as before when the stroke is taken back", async () => {
    await torus.settled();
    await meshed();
    const even = await torus.evaluate(meshOf);
    await torus.set("radius, % of size", 8);
    await torus.page.keyboard.press("b");
    const [x, y] = await torus.evaluate((c) => {
      for (let column = 60; ; column += 4) if (c.view.pick(column, 240) !== null) return [column + 16, 240];
    });
    const { mouse } = torus.page;
    await mouse.move(x, y);
    await mouse.down();
    await mouse.move(x + 4, y + 20, { steps: 4 });
    await torus.until((c) => c.settings.dabs.length > 0);
    const dab = await torus.evaluate((c) => c.settings.dabs[0]);
    const before = countWithin(even.positions, dab);
    const isDenser = (c, { dab: { centre, radius }, than }) => {
      const { positions, origin, count } = c.mesh.vertices;
      let within = 0;
      for (let v = 0; v < count; ++v) {
        if (Math.hypot(...centre.map((value, k) => value - origin[k] - positions[4 * v + k])) < radius) ++within;
      }
      return within > than;
    };
    await torus.until(isDenser, { dab, than: 2 * before }); // the button is still pressed
    await mouse.up();
    await torus.until((c) => c.isMeshCurrent);
    const painted = await torus.evaluate(meshOf);
    assert.ok(countWithin(painted.positions, dab) > 2 * before, `${countWithin(painted.positions, dab)}, and ${before} before`);
    assert.equal(painted.positions.length, vertices);
    await torus.picture("wireframe_painted.png");
    await torus.page.keyboard.press("Control+z");
    // What is not current may be so for less than a picture's time: the mesh itself tells.
    const isAsBefore = ({ isMeshCurrent, mesh: { vertices } }, first) =>
      isMeshCurrent && first.every((p, i) => p.every((value, k) => vertices.origin[k] + vertices.positions[4 * i + k] === value));
    await torus.until(isAsBefore, even.positions.slice(0, 30));
    assert.deepEqual(await torus.evaluate(meshOf), even);
    await torus.page.keyboard.press("b");
  });

  it("is saved as PLY", async () => {
    const [download] = await Promise.all([torus.page.waitForEvent("download"), torus.set("Save the mesh")]);
    assert.equal(download.suggestedFilename(), `torus-mesh-${vertices}.ply`);
    const header = readFileSync(await download.path(), "latin1").split("end_header\n")[0];
    assert.match(
      header,
      new RegExp(`element vertex ${vertices}\n[^]*element face ${2 * vertices}\nproperty list uchar uint vertex_indices\n`),
    );
  });
});

describe("a surface of many pieces", () => {
  it("says how many vertices it takes, and is meshed with so many", async () => {
    const file = join(temporaryFolder(), "pieces.off");
    writeFileSync(file, tetrahedra(6));
    const server = await Server.start("--open", file, "--points", "2000");
    const page = await WatchedPage.open(`${server.url}#points=1000&wireframe=1&meshVertices=100`);
    await page.page.getByText(/The mesh cannot be made: .*too few/).waitFor();
    assert.equal(await page.evaluate((c) => c.mesh), null);
    await page.set("vertices", 2000);
    await page.until((c) => c.mesh?.vertices.count === 2000);
    await page.close();
    await server.stop();
  });
});
