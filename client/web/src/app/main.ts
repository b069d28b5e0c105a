import "./panel.css";
import "./style.css";
import "./messages.css";

import { Client } from "../stream";
import { askFirst } from "./first_answers";
import { readSession, takeToken } from "./url_state";

const token = takeToken();
const client = new Client({ token });
const answers = askFirst(client, readSession(location.hash));
// The larger part of the page, which loads meanwhile.
const page = await import("./open").catch(() => null);
if (page !== null) page.open(client, answers, token);
else document.body.textContent = "A part of this page could not be loaded. Load the page again.";
