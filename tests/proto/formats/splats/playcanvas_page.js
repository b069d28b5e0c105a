// Draws splats in a .glb file with PlayCanvas, on a transparent background.

import * as pc from "playcanvas";

import { readPixels } from "./pixels.js";

const PATIENCE = 4000; // milliseconds: the engine sorts beside what it draws

window.draw = async (name, { eye, target, up, fov }, width, height) => {
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width, height });
  document.body.append(canvas);
  const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ["webgl2"], antialias: false, preserveDrawingBuffer: true });
  device.maxPixelRatio = 1;
  const options = new pc.AppOptions();
  options.graphicsDevice = device;
  options.componentSystems = [pc.CameraComponentSystem, pc.GSplatComponentSystem, pc.RenderComponentSystem];
  options.resourceHandlers = [pc.ContainerHandler, pc.TextureHandler, pc.GSplatHandler];
  const app = new pc.AppBase(canvas);
  app.init(options);
  app.setCanvasFillMode(pc.FILLMODE_NONE);
  app.setCanvasResolution(pc.RESOLUTION_FIXED, width, height);
  app.start();
  const asset = new pc.Asset("splats", "container", { url: `/files/${name}` });
  app.assets.add(asset);
  await new Promise((resolve, reject) => {
    asset.ready(resolve);
    asset.on("error", reject);
    app.assets.load(asset);
  });
  app.root.addChild(asset.resource.instantiateRenderEntity());
  const camera = new pc.Entity();
  camera.addComponent("camera", { clearColor: new pc.Color(0, 0, 0, 0), fov, nearClip: 0.01, farClip: 100 });
  camera.setPosition(...eye);
  camera.lookAt(new pc.Vec3(...target), new pc.Vec3(...up));
  app.root.addChild(camera);
  await new Promise((resolve) => setTimeout(resolve, PATIENCE));
  return { count: asset.resource.gsplats[0].resource.numSplats, pixels: readPixels(device.gl, width, height) };
};
window.ready = true;
