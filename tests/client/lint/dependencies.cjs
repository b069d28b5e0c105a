// Which file of the viewer may import which, types included: no cycles; stream < view < app < element, and cloud beside view; each package
// behind its own door.
// deploy/check_web runs it from the root of the sources.

const source = "^client/web/src";
const packages = "node_modules";

/// `names` (a pattern of packages) may be imported by files that match `doors`, and by no others.
const onlyFrom = (names, doors) => ({
  name: `${names}-behind-its-door`,
  severity: "error",
  from: { path: source, pathNot: doors },
  to: { path: `${packages}/(@types/)?(${names})` },
});

module.exports = {
  forbidden: [
    { name: "no-cycles", severity: "error", from: {}, to: { circular: true } },
    { name: "all-is-found", severity: "error", from: { path: source }, to: { couldNotResolve: true } },
    {
      name: "stream-below-view-and-app",
      severity: "error",
      from: { path: `${source}/stream/` },
      to: { path: `${source}/(view|cloud|app|element)/` },
    },
    {
      name: "view-below-app",
      severity: "error",
      from: { path: `${source}/view/` },
      to: { path: `${source}/(cloud|app|element)/` },
    },
    {
      name: "cloud-below-app",
      severity: "error",
      from: { path: `${source}/cloud/` },
      to: { path: `${source}/(view|app|element)/` },
    },
    { name: "app-below-element", severity: "error", from: { path: `${source}/app/` }, to: { path: `${source}/element/` } },
    onlyFrom("three", `${source}/(view/|example[.]ts)`),
    onlyFrom("lil-gui", `${source}/app/panel[.]ts`),
    onlyFrom("draco3d", `${source}/stream/draco/(library|wasm)[.]ts`),
  ],
  options: {
    tsPreCompilationDeps: true, // types, too
    tsConfig: { fileName: require("node:path").resolve("client/web/tsconfig.json") },
    doNotFollow: { path: packages },
    enhancedResolveOptions: { exportsFields: ["exports"], conditionNames: ["import", "types", "default"] },
  },
};
