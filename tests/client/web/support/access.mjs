// What keeps a page from some of its users.

import { axeSource } from "./environment.mjs";

/// What axe finds wrong with the page as it is.
export async function faultsOf(watched) {
  await watched.page.evaluate(axeSource);
  return watched.page.evaluate(async () => {
    const { violations } = await window.axe.run(document);
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join(" ")}`);
  });
}
