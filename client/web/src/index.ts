// Curvecast for other pages: the streaming client, and its points as an object of three.js.

export * from "./stream";
export * from "./view";
