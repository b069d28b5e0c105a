// Loads a tileset, a file beside the page or an address, with 3d-tiles-renderer into a scene of three.js. A page whose import map says where both are.

import * as THREE from "three";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { TilesRenderer } from "3d-tiles-renderer/three";

import { readPixels } from "../splats/pixels.js";

const STILL = 12; // pictures without anything to load: then all that the view wants is there

window.draw = async (name, { eye, target, up, fov, error, headers, spacing }, width, height) => {
  const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  renderer.setClearColor(0, 0);
  document.body.append(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(fov, width / height, 0.01, 100);
  camera.position.set(...eye);
  camera.up.set(...up);
  camera.lookAt(...target);
  camera.updateMatrixWorld();
  const tiles = new TilesRenderer(new URL(name, `${location.origin}/files/`).href);
  if (headers) tiles.fetchOptions = { ...tiles.fetchOptions, headers };
  const loader = new GLTFLoader(tiles.manager);
  loader.setMeshoptDecoder(MeshoptDecoder);
  tiles.manager.addHandler(/\.gl(b|tf)$/, loader);
  tiles.errorTarget = error;
  tiles.setCamera(camera);
  tiles.setResolutionFromRenderer(camera, renderer);
  const failed = [];
  tiles.addEventListener("load-error", ({ error: why, url }) => failed.push(`${url}: ${why}`));
  let still = 0;
  tiles.addEventListener("load-model", () => (still = 0));
  const scene = new THREE.Scene();
  // The set's third axis points upwards; the mesh's second one does.
  tiles.group.rotation.x = -Math.PI / 2;
  scene.add(tiles.group);
  let count = 0;
  const box = new THREE.Box3();
  for (still = 0; still < STILL && failed.length === 0; ++still) {
    scene.updateMatrixWorld(true);
    tiles.update();
    count = 0;
    box.makeEmpty();
    tiles.group.traverse((node) => {
      if (!node.isPoints) return;
      count += node.geometry.getAttribute("position").count;
      // Discs as wide as neighbours of the points that are there are apart.
      node.material.sizeAttenuation = true;
      node.material.size = spacing / Math.tan((fov * Math.PI) / 360); // three.js takes an angle of 90 degrees
      box.expandByObject(node);
    });
    renderer.render(scene, camera);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  return {
    count,
    failed,
    low: box.min.toArray(),
    high: box.max.toArray(),
    pixels: readPixels(renderer.getContext(), width, height),
  };
};
window.ready = true;
