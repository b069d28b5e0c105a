import "./style.css";

import { NoWebGL2Error } from "../view";
import { Application } from "./app";
import { handleOf } from "./handle";
import { Messages } from "./messages";
import { takeToken } from "./url_state";

const canvas = document.querySelector("canvas")!;
const messages = new Messages(document.body);
try {
  window.curvecast = handleOf(new Application(canvas, document.body, messages, takeToken()));
} catch (thrown) {
  if (!(thrown instanceof NoWebGL2Error)) throw thrown;
  messages.noWebGL2();
}
