import { describe, expect, it } from "vitest";

import { defaultSettings, type Settings } from "../../../../client/web/src/app/settings";
import { readState, writeState } from "../../../../client/web/src/app/url_state";
import type { CameraState } from "../../../../client/web/src/view/types";

const defaults = defaultSettings(false, "light");
const camera: CameraState = { eye: [1.5, -2, 3], target: [0, 0.25, 0], up: [0, 1, 0], fov: 30 };

describe("the address", () => {
  it("keeps a session, the camera and what is not as usual", () => {
    const settings: Settings = {
      ...defaults,
      points: 12_345,
      mode: "dots",
      screen: false,
      curvature: "max",
      splatScale: 1.25,
      dabs: [
        { centre: [1, 2, 3], radius: 0.5, factor: 0, stroke: 0 },
        { centre: [4, 5, 6], radius: 0.25, factor: 8, stroke: 1 },
        { centre: [4.5, 5, 6], radius: 0.25, factor: 8, stroke: 1 },
      ],
    };
    const hash = writeState("abc", camera, settings, defaults);
    expect(hash.startsWith("#session=abc&camera=1.5,-2,3,0,0.25,0,0,1,0,30&")).toBe(true);
    const state = readState(hash, defaults);
    expect(state.session).toBe("abc");
    expect(state.camera).toEqual(camera);
    expect({ ...defaults, ...state.settings }).toEqual(settings);
  });

  it("keeps whether the camera is orthographic", () => {
    const hash = writeState("abc", { ...camera, orthographic: true }, { ...defaults, projection: "orthographic" }, defaults);
    expect(hash).toContain("projection=orthographic");
    expect(readState(hash, defaults)).toMatchObject({
      camera: { ...camera, orthographic: true },
      settings: { projection: "orthographic" },
    });
  });

  it("is short where all is as usual", () => {
    expect(writeState("abc", null, { ...defaults }, defaults)).toBe("#session=abc&points=50000&background=light");
    expect(readState("", defaults)).toEqual({ session: null, camera: null, settings: {} });
  });

  it("does not keep tools, nor take them", () => {
    const dabs = Array.from({ length: 501 }, () => ({
      centre: [0, 0, 0] as [number, number, number],
      radius: 1,
      factor: 2,
      stroke: 0,
    }));
    expect(writeState(null, null, { ...defaults, dabs, brush: true, eraser: true, measuring: true, frozen: true }, defaults)).toBe(
      "#points=50000&background=light",
    );
    expect(readState("#brush=1&frozen=1", defaults).settings).toEqual({});
  });

  it("means the same on another machine", () => {
    const state = readState(writeState(null, null, defaults, defaults), defaultSettings(true, "dark"));
    expect(state.settings).toEqual({ points: defaults.points, background: "light" });
  });

  it("keeps twelve digits", () => {
    const far = { ...camera, eye: [4_512_345.67891, -2, 5.25e-7] as [number, number, number] };
    const dab = { centre: [4_512_345.67891, 1, 2] as [number, number, number], radius: 1e-9, factor: 2, stroke: 0 };
    const state = readState(writeState("abc", far, { ...defaults, dabs: [dab] }, defaults), defaults);
    expect(state.camera).toEqual(far);
    expect(state.settings.dabs).toEqual([dab]);
  });

  it("takes numbers within their ranges only", () => {
    const read = (hash: string) => readState(hash, defaults).settings;
    expect(read("#points=1e20&kilobytes=-5&splatScale=0&brushFactor=0&dotSize=11")).toEqual({
      points: 1_000_000,
      kilobytes: 4,
      splatScale: 0.2,
      brushFactor: 0,
      dotSize: 10,
    });
    expect(read("#points=Infinity&kilobytes=&dotSize=%20&dabs=1,1e9,0,0,0")).toEqual({
      dabs: [{ centre: [0, 0, 0], radius: 1, factor: 64, stroke: 0 }],
    });
    const settings = { ...defaults, brushFactor: 0 };
    expect(read(writeState(null, null, settings, defaults)).brushFactor).toBe(0);
  });

  it("leaves out what makes no sense", () => {
    const hash =
      "#points=many&splatScale=x&mode=cubes&edl=yes&sampler=equalised&camera=1,2,3,1,2,3,0,1,0,30" +
      "&dabs=1,2;-1,2,1,2,3;1,2,1,2,3,4;x&__proto__=1";
    expect(readState(hash, defaults)).toEqual({ session: null, camera: null, settings: { sampler: "equalised", dabs: [] } });
    for (const fov of ["180", "NaN", "0.5", "170"])
      expect(readState(`#camera=0,0,1,0,0,0,0,1,0,${fov}`, defaults).camera).toBeNull();
    for (const text of ["1,2,3", "0,0,1,0,0,0,0,0,0,30"]) {
      expect(readState(`#camera=${text}`, defaults).camera).toBeNull();
    }
  });
});
