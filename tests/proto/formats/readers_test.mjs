// Khronos' validator, three.js and Google's decoder of Draco read files of points. deploy/test fetches them; without them this test is
// skipped.

import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";

import { curvecast, folder, Packages, rankedPoints, readPly, writeTorus } from "./coloured_points.mjs";
import { compared, within } from "./reader_table.mjs";

const packages = new Packages(process.env.CURVECAST_NODE_MODULES ?? "build/formats/node_modules");
const validator = packages.require("gltf-validator");
const THREE = await packages.import("three/build/three.module.js");
const draco = await packages.require("draco3d").createDecoderModule({});
const { GLTFLoader } = await packages.import("three/examples/jsm/loaders/GLTFLoader.js");
const { PCDLoader } = await packages.import("three/examples/jsm/loaders/PCDLoader.js");
const { PLYLoader } = await packages.import("three/examples/jsm/loaders/PLYLoader.js");
const { MeshoptDecoder } = await packages.import("three/examples/jsm/libs/meshopt_decoder.module.js");

const COUNT = 3000;
const NUMBERS = ["floats", "quantised", "meshopt"];
const [VALIDATOR, THREE_JS] = [packages.named("gltf-validator", "Khronos' glTF validator"), packages.named("three", "three.js")];

/** A file of points. `words`: further ones of the command. */
function sample(mesh, name, ...words) {
  const path = join(folder, name);
  curvecast("sample", mesh, "-n", String(COUNT), ...words, "-o", path);
  return readFileSync(path);
}

const ranked = (mesh, name, ...words) => sample(mesh, name, "--sampler", "progressive", ...words);

const bufferOf = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

/** The points of a .glb file, as three.js makes them. */
async function load(bytes) {
  const loader = new GLTFLoader();
  loader.setMeshoptDecoder(MeshoptDecoder);
  const { scene } = await loader.parseAsync(bufferOf(bytes), "");
  scene.updateMatrixWorld(true);
  const found = [];
  scene.traverse((object) => object.isPoints && found.push(object));
  assert.equal(found.length, 1);
  return found[0];
}

/** What the validator finds wrong with a .glb file. */
async function validate(bytes) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  return issues.messages.filter(({ severity }) => severity < 2).map(({ code }) => code);
}

/** From sRGB to light. */
const light = (channel) => new THREE.Color().setRGB(channel / 255, 0, 0, THREE.SRGBColorSpace).r;

/** How far, along an axis, places of an attribute are from points at most. Fails beyond `most`. */
function farthest(position, points, most, matrix = new THREE.Matrix4()) {
  assert.equal(position.count, points.length);
  const place = new THREE.Vector3();
  let worst = 0;
  points.forEach((point, i) => {
    place.fromBufferAttribute(position, i).applyMatrix4(matrix);
    for (const axis of ["x", "y", "z"]) worst = Math.max(worst, Math.abs(place[axis] - point[axis]));
  });
  assert.ok(worst <= most, `points are ${worst} away`);
  return worst;
}

/** Fails where a normal leans by more than of this cosine. */
function sameNormals(normal, points, cosine) {
  const [across, own] = [new THREE.Vector3(), new THREE.Vector3()];
  points.forEach((point, i) => {
    own.set(point.nx, point.ny, point.nz).normalize();
    assert.ok(across.fromBufferAttribute(normal, i).normalize().dot(own) > cosine, `normal of point ${i}`);
  });
}

function sameColours(color, points, most = 1e-4) {
  points.forEach((point, i) => {
    for (const [k, channel] of [point.red, point.green, point.blue].entries()) {
      assert.ok(Math.abs(color.getComponent(i, k) - light(channel)) < most, `colour of point ${i}`);
    }
  });
}

const far = [500_000.25, 0, -4_600_000.5];
const meshes = [
  ["near", writeTorus("near.ply"), 1e-12],
  ["far out", writeTorus("far.ply", far), 2e-9],
];
after(() => rmSync(folder, { recursive: true }));

for (const [where, mesh, doubles] of meshes) {
  const points = rankedPoints(mesh, "-n", String(COUNT));

  describe(`points of a mesh ${where}`, () => {
    for (const numbers of NUMBERS) {
      it(`are read as ${numbers}`, async () => {
        const bytes = ranked(mesh, `${numbers}.glb`, "--glb", numbers);
        await compared(`.glb, ${numbers}`, VALIDATOR, "the whole file", async () => {
          assert.deepEqual(await validate(bytes), []);
          return "valid";
        });
        await compared(`.glb, ${numbers}`, THREE_JS, "places, normals, colours, radii", async () => {
          const { geometry, matrixWorld } = await load(bytes);
          const { position, normal, color, _radius: radius } = geometry.attributes;
          // Half a step of 65,535 along the longest side, 2.8 units.
          const most = numbers === "floats" ? doubles : doubles + (0.51 * 2.8) / 65535;
          const worst = farthest(position, points, most, matrixWorld);
          sameNormals(normal, points, numbers === "floats" ? 1 - 1e-6 : 0.9998);
          sameColours(color, points);
          points.forEach((point, i) =>
            assert.ok(Math.abs(radius.getX(i) / point.radius - 1) < (numbers === "meshopt" ? 4e-5 : 1e-7)),
          );
          return `${where}: ${within(worst)}`;
        });
      });
    }

    it("are splats that are valid but for the extension's own attributes, and points to others", async () => {
      const bytes = ranked(mesh, "splats.glb", "--splats");
      await compared(".glb of splats", VALIDATOR, "the whole file", async () => {
        // The validator does not know the extension.
        assert.deepEqual(await validate(bytes), Array(4).fill("MESH_PRIMITIVE_INVALID_ATTRIBUTE"));
        return "valid, but that it does not know the extension";
      });
      await compared(".glb of splats", THREE_JS, "places, as points", async () => {
        const { geometry, matrixWorld } = await load(bytes);
        return `${where}: ${within(farthest(geometry.attributes.position, points, doubles, matrixWorld))}`;
      });
    });
  });
}

describe("points along the curve", () => {
  const [, mesh] = meshes[0];
  let points;
  before(() => {
    sample(mesh, "own.ply");
    points = readPly(join(folder, "own.ply"));
  });

  it("are read from .ply", () =>
    compared(".ply", THREE_JS, "places, normals, colours", () => {
      const { position, normal, color } = new PLYLoader().parse(bufferOf(sample(mesh, "points.ply"))).attributes;
      const worst = farthest(position, points, 0);
      sameNormals(normal, points, 1 - 1e-6);
      sameColours(color, points, 0.51 / 255); // three.js keeps 8 bits
      return within(worst);
    }));

  it("are read from .pcd", () =>
    compared(".pcd", THREE_JS, "places, normals, colours", () => {
      const { position, normal, color } = new PCDLoader().parse(bufferOf(sample(mesh, "points.pcd"))).geometry.attributes;
      const worst = farthest(position, points, 0);
      sameNormals(normal, points, 1 - 1e-6);
      sameColours(color, points);
      return within(worst);
    }));

  it("are read from .drc", () =>
    compared(".drc", packages.named("draco3d"), "places, normals, colours", () => {
      const { POSITION, NORMAL, COLOR } = readDraco(sample(mesh, "points.drc"));
      const worst = farthest(new THREE.BufferAttribute(POSITION, 3), points, (0.51 * 2.8) / 65535);
      sameNormals(new THREE.BufferAttribute(NORMAL, 3), points, 0.9999);
      points.forEach((point, i) => assert.deepEqual([...COLOR.slice(3 * i, 3 * i + 3)], [point.red, point.green, point.blue]));
      return within(worst);
    }));
});

/** The columns of a .drc file, by the names that Draco has for them. */
function readDraco(bytes) {
  const decoder = new draco.Decoder();
  const cloud = new draco.PointCloud();
  const status = decoder.DecodeArrayToPointCloud(bytes, bytes.length, cloud);
  assert.ok(status.ok(), status.error_msg());
  const values = new draco.DracoFloat32Array();
  return Object.fromEntries(
    ["POSITION", "NORMAL", "COLOR"].map((name) => {
      const attribute = decoder.GetAttribute(cloud, decoder.GetAttributeId(cloud, draco[name]));
      decoder.GetAttributeFloatForAllPoints(cloud, attribute, values);
      return [name, Float32Array.from({ length: values.size() }, (_, i) => values.GetValue(i))];
    }),
  );
}

describe("a file of fewer points", () => {
  it("is the beginning of one of more", async () => {
    const [, mesh] = meshes[0];
    const [few, many] = [[], []];
    for (const [list, count] of [
      [few, 500],
      [many, COUNT],
    ]) {
      const path = join(folder, `${count}.glb`);
      curvecast("sample", mesh, "-n", String(count), "--sampler", "progressive", "--glb", "floats", "-o", path);
      const { position } = (await load(readFileSync(path))).geometry.attributes;
      for (let i = 0; i < 500; ++i) list.push([position.getX(i), position.getY(i), position.getZ(i)]);
    }
    assert.deepEqual(few, many);
  });
});
