// Draws a file of splats with Spark, on a transparent background. A page whose import map says where three.js and Spark are.

import * as THREE from "three";
import { SparkRenderer, SplatMesh } from "@sparkjsdev/spark";

import { readPixels } from "./pixels.js";

const FRAMES = 6; // Spark sorts beside what it draws: so many pictures later it has

window.draw = async (name, { eye, target, up, fov }, width, height) => {
  const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  renderer.setClearColor(0, 0);
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.add(new SparkRenderer({ renderer }));
  const camera = new THREE.PerspectiveCamera(fov, width / height, 0.01, 100);
  camera.position.set(...eye);
  camera.up.set(...up);
  camera.lookAt(...target);
  const bytes = new Uint8Array(await (await fetch(`/files/${name}`)).arrayBuffer());
  const splats = new SplatMesh({ fileBytes: bytes, fileName: name });
  scene.add(splats);
  await splats.initialized;
  for (let i = 0; i < FRAMES; ++i) {
    renderer.render(scene, camera);
    await new Promise((resolve) => setTimeout(resolve, 400));
  }
  return { count: splats.packedSplats.numSplats, pixels: readPixels(renderer.getContext(), width, height) };
};
window.ready = true;
