// Loads a tileset, a file beside the page or an address, with Cesium, at a place on the globe. A page whose import map says where Cesium is.

window.CESIUM_BASE_URL = "/packages/cesium/Build/Cesium/";
const Cesium = await import("/packages/cesium/Build/Cesium/index.js");

import { readPixels } from "../splats/pixels.js";

const STILL = 12; // pictures without anything to load

window.draw = async (name, { eye, target, up, fov, error, headers, size }, width, height) => {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  [canvas.style.width, canvas.style.height] = [`${width}px`, `${height}px`];
  document.body.append(canvas);
  const scene = new Cesium.Scene({ canvas, contextOptions: { webgl: { alpha: true, preserveDrawingBuffer: true } } });
  scene.backgroundColor = new Cesium.Color(0, 0, 0, 0);
  scene.globe = undefined;
  scene.skyBox = scene.skyAtmosphere = scene.sun = scene.moon = undefined;
  scene.highDynamicRange = false;
  const frame = Cesium.Transforms.eastNorthUpToFixedFrame(Cesium.Cartesian3.fromDegrees(10, 50, 1000));
  const source = new Cesium.Resource({ url: new URL(name, `${location.origin}/files/`).href, headers });
  const tileset = await Cesium.Cesium3DTileset.fromUrl(source, { modelMatrix: frame, maximumScreenSpaceError: error });
  tileset.style = new Cesium.Cesium3DTileStyle({ pointSize: size });
  scene.primitives.add(tileset);
  const failed = [];
  tileset.tileFailed.addEventListener(({ url, message }) => failed.push(`${url}: ${message}`));
  // The mesh's second axis becomes the third one of the set.
  const turned = ([x, y, z]) => new Cesium.Cartesian3(x, -z, y);
  const place = (p) => Cesium.Matrix4.multiplyByPoint(frame, turned(p), new Cesium.Cartesian3());
  const direction = (a, b) =>
    Cesium.Cartesian3.normalize(Cesium.Cartesian3.subtract(b, a, new Cesium.Cartesian3()), new Cesium.Cartesian3());
  const position = place(eye);
  scene.camera.frustum.fov =
    width > height ? 2 * Math.atan(Math.tan((fov * Math.PI) / 360) * (width / height)) : (fov * Math.PI) / 180;
  scene.camera.frustum.aspectRatio = width / height;
  scene.camera.frustum.near = 0.01;
  scene.camera.setView({
    destination: position,
    orientation: {
      direction: direction(position, place(target)),
      up: Cesium.Matrix4.multiplyByPointAsVector(frame, turned(up), new Cesium.Cartesian3()),
    },
  });
  let count = 0;
  for (let still = 0; still < STILL && failed.length === 0; ++still) {
    scene.initializeFrame();
    scene.render();
    const statistics = tileset.statistics;
    if (!tileset.tilesLoaded) still = 0;
    count = statistics.numberOfPointsSelected;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  return { count, failed, pixels: readPixels(scene.context._gl, width, height) };
};
window.ready = true;
