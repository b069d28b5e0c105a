// The viewer in a real browser, with a real server. Prints where pictures of it are.

import { after } from "node:test";

import { pictureFile } from "./support/environment.mjs";
import { endAll } from "./support/shared_server.mjs";

import "./poster_suite.mjs";
import "./picture_suite.mjs";
import "./crease_suite.mjs";
import "./gallery_suite.mjs";
import "./outline_suite.mjs";
import "./views_suite.mjs";
import "./access_suite.mjs";
import "./tools_suite.mjs";
import "./film_suite.mjs";
import "./marks_suite.mjs";
import "./mesh_suite.mjs";
import "./surface_suite.mjs";
import "./server_suite.mjs";
import "./leak_suite.mjs";

console.log(`# pictures: ${pictureFile("")}`);
after(endAll);
