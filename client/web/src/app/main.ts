// SPDX-License-Identifier: Apache-2.0
// Loads the larger part of the page once the poster is on its way.

import { poster, token } from "./first";

await poster.passed();
// Both at once: the first questions are asked while the larger part is still to come.
const begun = import("./begin").then(({ begin }) => begin(token, poster));
const parts = await Promise.all([import("./open"), begun]).catch(() => null);
if (parts !== null) parts[0].open(parts[1]);
else document.body.textContent = "A part of this page could not be loaded. Load the page again.";
