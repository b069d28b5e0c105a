// A server of files, as any host of pages is one: another origin than curvecast's.

import { createReadStream, existsSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";

const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css" };

export class StaticSite {
  /// Serves a folder. `headers`: of all answers.
  static async start(folder, headers = {}) {
    const site = new StaticSite();
    site.listener = createServer((request, response) => {
      if (request.url === "/favicon.ico") return response.writeHead(204).end(); // browsers ask for it by themselves
      const path = join(folder, normalize(decodeURIComponent(new URL(request.url, "http://site").pathname)));
      if (!existsSync(path) || !statSync(path).isFile()) return response.writeHead(404).end();
      response.writeHead(200, { "content-type": types[extname(path)] ?? "application/octet-stream", ...headers });
      createReadStream(path).pipe(response);
    });
    await new Promise((resolve) => site.listener.listen(0, "127.0.0.1", resolve));
    site.origin = `http://127.0.0.1:${site.listener.address().port}`;
    return site;
  }

  async stop() {
    this.listener.closeAllConnections();
    await new Promise((resolve) => this.listener.close(resolve));
  }
}
