// Draws the points of a .glb file with three.js alone, on a transparent background. A page whose import map says where that is.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

import { readPixels } from "../splats/pixels.js";

/** `spacing`: between neighbours, in units. */
window.draw = async (name, { eye, target, up, fov, spacing }, width, height) => {
  const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height);
  renderer.setClearColor(0, 0);
  document.body.append(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(fov, width / height, 0.01, 100);
  camera.position.set(...eye);
  camera.up.set(...up);
  camera.lookAt(...target);
  const loader = new GLTFLoader();
  loader.setMeshoptDecoder(MeshoptDecoder);
  const { scene } = await loader.loadAsync(`/files/${name}`);
  let count = 0;
  scene.traverse((node) => {
    if (!node.isPoints) return;
    count += node.geometry.getAttribute("position").count;
    node.material.sizeAttenuation = true; // points of glTF have one pixel otherwise
    node.material.size = spacing / Math.tan((fov * Math.PI) / 360); // three.js takes an angle of 90 degrees
  });
  renderer.render(scene, camera);
  return { count, pixels: readPixels(renderer.getContext(), width, height) };
};
window.ready = true;
