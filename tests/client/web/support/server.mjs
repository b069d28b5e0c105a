// `curvecast serve` as a process of its own.

import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { command, skip } from "./environment.mjs";

let folders = null;

/// A folder that goes with the process.
export function temporaryFolder() {
  if (folders === null) {
    folders = mkdtempSync(join(tmpdir(), "curvecast-viewer-"));
    process.on("exit", () => rmSync(folders, { recursive: true, force: true }));
  }
  return mkdtempSync(join(folders, "x"));
}

/// Its JSON, which is printed once it is ready. What it prints is read to the end, so that it never waits for that.
function announcement(child, log) {
  let out = "";
  return new Promise((resolve, reject) => {
    child.on("error", reject);
    child.on("exit", (status) => reject(new Error(`curvecast serve has ended with status ${status}:\n${log()}`)));
    child.stdout.on("data", (data) => {
      out += data;
      if (!out.trimEnd().endsWith("}")) return;
      try {
        resolve(JSON.parse(out));
      } catch {
        // A brace of the inside; the rest is to come.
      }
    });
  });
}

/// One server; `options` are further ones of the command. It can be killed and started again at the same address.
export class Server {
  #options;
  #child = null;
  #exit = null;
  #log = "";

  /// Starts it, and waits until it is ready. `http`: where, once it is.
  static async start(...options) {
    const server = new Server();
    server.#options = ["--listen", "127.0.0.1:0", "--drain", "1", "--json", ...options];
    await server.#run("127.0.0.1:0");
    return server;
  }

  async #run(address) {
    const child = spawn(command, ["serve", "--http", address, ...this.#options], { stdio: ["ignore", "pipe", "pipe"] });
    const end = () => child.kill("SIGKILL");
    process.on("exit", end);
    this.#child = child;
    this.#exit = once(child, "exit").finally(() => process.off("exit", end));
    this.#log = "";
    child.stderr.on("data", (data) => (this.#log += data));
    const { address: grpc, http, viewer, sessions } = await announcement(child, () => this.#log);
    this.grpc = grpc; // its address
    this.http = http;
    this.url = viewer;
    this.sessions = sessions.map(({ session_id }) => session_id);
    const page = await fetch(this.url);
    if (!(page.headers.get("content-type") ?? "").startsWith("text/html") || !(await page.text()).includes("<canvas")) {
      skip("the command was built without the viewer");
    }
  }

  /// Waits until its log says so, since it was started.
  async logged(pattern) {
    while (!pattern.test(this.#log)) await once(this.#child.stderr, "data");
  }

  async kill() {
    this.#child.kill("SIGKILL");
    await this.#exit;
  }

  /// Once more, at the same address, after kill() or stop().
  async restart() {
    await this.#run(this.http);
  }

  async stop() {
    this.#child.kill("SIGTERM");
    await this.#exit;
  }
}
