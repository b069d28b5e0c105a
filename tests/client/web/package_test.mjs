// The npm package: packed, unpacked into an empty folder, and used there.

import { after } from "node:test";

import { endPackageSite } from "./support/package_site.mjs";

import "./element_suite.mjs";
import "./notebook_suite.mjs";
import "./package_suite.mjs";

after(endPackageSite);
