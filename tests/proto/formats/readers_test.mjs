// Khronos' validator and three.js read .glb files of points. deploy/test fetches them; without them this test is skipped.

import assert from "node:assert/strict";
import { readFileSync, rmSync } from "node:fs";
import { join } from "node:path";
import { after, describe, it } from "node:test";

import { curvecast, folder, Packages, rankedPoints, writeTorus } from "./coloured_points.mjs";

const packages = new Packages(process.env.CURVECAST_NODE_MODULES ?? "build/formats/node_modules");
const validator = packages.require("gltf-validator");
const THREE = await packages.import("three/build/three.module.js");
const { GLTFLoader } = await packages.import("three/examples/jsm/loaders/GLTFLoader.js");
const { MeshoptDecoder } = await packages.import("three/examples/jsm/libs/meshopt_decoder.module.js");

const COUNT = 3000;
const NUMBERS = ["floats", "quantised", "meshopt"];

function sample(mesh, name, ...words) {
  const path = join(folder, name);
  curvecast("sample", mesh, "-n", String(COUNT), "--sampler", "progressive", ...words, "-o", path);
  return readFileSync(path);
}

/** The points of a file, as three.js makes them. */
async function load(bytes) {
  const loader = new GLTFLoader();
  loader.setMeshoptDecoder(MeshoptDecoder);
  const { scene } = await loader.parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength), "");
  scene.updateMatrixWorld(true);
  const found = [];
  scene.traverse((object) => object.isPoints && found.push(object));
  assert.equal(found.length, 1);
  return found[0];
}

async function validate(bytes) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  return issues.messages.filter(({ severity }) => severity < 2).map(({ code }) => code);
}

/** From sRGB to light. */
const light = (channel) => new THREE.Color().setRGB(channel / 255, 0, 0, THREE.SRGBColorSpace).r;

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
        const bytes = sample(mesh, `${numbers}.glb`, "--glb", numbers);
        assert.deepEqual(await validate(bytes), []);
        const { geometry, matrixWorld } = await load(bytes);
        const { position, normal, color, _radius: radius } = geometry.attributes;
        assert.equal(position.count, COUNT);
        // Half a step of 65,535 along the longest side, 2.8 units.
        const most = numbers === "floats" ? doubles : doubles + (0.51 * 2.8) / 65535;
        const [place, across] = [new THREE.Vector3(), new THREE.Vector3()];
        points.forEach((point, i) => {
          place.fromBufferAttribute(position, i).applyMatrix4(matrixWorld);
          for (const axis of ["x", "y", "z"]) assert.ok(Math.abs(place[axis] - point[axis]) <= most, `${axis} of point ${i}`);
          across.fromBufferAttribute(normal, i).normalize();
          assert.ok(
            across.dot(new THREE.Vector3(point.nx, point.ny, point.nz).normalize()) > (numbers === "floats" ? 1 - 1e-6 : 0.9998),
          );
          for (const [k, channel] of [point.red, point.green, point.blue].entries()) {
            assert.ok(Math.abs(color.getComponent(i, k) - light(channel)) < 1e-4);
          }
          assert.ok(Math.abs(radius.getX(i) / point.radius - 1) < (numbers === "meshopt" ? 4e-5 : 1e-7));
        });
      });
    }

    it("are splats that are valid but for the extension's own attributes, and points to others", async () => {
      const bytes = sample(mesh, "splats.glb", "--splats");
      // The validator does not know the extension.
      assert.deepEqual(await validate(bytes), Array(4).fill("MESH_PRIMITIVE_INVALID_ATTRIBUTE"));
      const { geometry, matrixWorld } = await load(bytes);
      const place = new THREE.Vector3();
      points.forEach((point, i) => {
        place.fromBufferAttribute(geometry.attributes.position, i).applyMatrix4(matrixWorld);
        for (const axis of ["x", "y", "z"]) assert.ok(Math.abs(place[axis] - point[axis]) <= doubles);
      });
    });
  });
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
