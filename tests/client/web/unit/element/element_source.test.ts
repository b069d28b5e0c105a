import { describe, expect, it } from "vitest";

import { defaultSettings } from "../../../../../client/web/src/app/settings";
import { sessionSource, shownSettings, type Attributes } from "../../../../../client/web/src/element/element_source";

const page = "https://page.example/of/mine.html";
const defaults = defaultSettings(false, "light");
const attributes =
  (given: Partial<Record<Parameters<Attributes>[0], string>>): Attributes =>
  (name) =>
    given[name] ?? null;

describe("the source of an element", () => {
  it("is the socket of the server that src names, beside the viewer's page", () => {
    const urlOf = (src: string) => sessionSource(attributes({ src }), page).url;
    expect(urlOf("https://points.example/")).toBe("wss://points.example/v1/socket");
    expect(urlOf("http://points.example:8080/#session=a&points=5")).toBe("ws://points.example:8080/v1/socket");
    expect(urlOf("https://points.example/below/index.html?x=1#session=a")).toBe("wss://points.example/below/v1/socket");
    expect(urlOf("wss://points.example/")).toBe("wss://points.example/v1/socket");
    expect(urlOf("/below/")).toBe("wss://page.example/below/v1/socket");
    expect(urlOf("#session=a")).toBe("wss://page.example/of/v1/socket");
  });

  it("has session and token of the attributes, else those of the address", () => {
    const src = "https://points.example/#session=a%20b&token=t%2Bt";
    expect(sessionSource(attributes({ src }), page)).toMatchObject({ sessionId: "a b", token: "t+t" });
    expect(sessionSource(attributes({ src, session: "c", token: "d" }), page)).toMatchObject({ sessionId: "c", token: "d" });
    expect(sessionSource(attributes({ src: "/" }), page)).toMatchObject({ sessionId: null, token: undefined });
  });

  it.each(["https://", "mailto:me@example.org", "javascript:alert(1)", "file:///etc/passwd"])("is an error of %s", (src) => {
    expect(() => sessionSource(attributes({ src }), page)).toThrow(/^src is no address.*/);
  });
});

describe("the settings of an element", () => {
  const src =
    "https://points.example/#session=a&camera=0,0,5,0,0,0,0,1,0,40&budget=bytes&mode=dots&colouring=normal&up=z&split=1&wireframe=1";

  it("are those of the address, without the viewer's tools", () => {
    const { camera, settings } = shownSettings(attributes({ src }), defaults);
    expect(camera).toEqual({ eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov: 40 });
    expect(settings).toEqual({ ...defaults, budget: "bytes", mode: "dots", colouring: "normal", up: "z" });
  });

  it("are those of attributes first", () => {
    const { settings } = shownSettings(attributes({ src, points: "70000", mode: "mesh", background: "dark" }), defaults);
    expect(settings).toMatchObject({ budget: "points", points: 70_000, mode: "mesh", background: "dark", colouring: "normal" });
  });

  it("are as usual where an attribute cannot be understood, and within their ranges", () => {
    const { settings } = shownSettings(attributes({ src: "/", points: "many", mode: "ghost", colouring: "" }), defaults);
    expect(settings).toEqual(defaults);
    expect(shownSettings(attributes({ src: "/", points: "1e12" }), defaults).settings.points).toBe(1_000_000);
  });
});
