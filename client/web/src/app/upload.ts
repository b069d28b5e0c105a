// SPDX-License-Identifier: Apache-2.0
// Opens files that the user drops or chooses: makes sessions of meshes, and reads point clouds here.

import { cloudAmong, openCloud, type Cloud } from "../cloud";
import { asCurvecastError, meshAmong, type Client, type CurvecastError, type NamedFile, type Session } from "../stream";
import { droppedFiles } from "./dropped_files";
import { button, element } from "./elements";
import { bytes } from "./format";

/// The outcomes of an upload.
export interface UploadEvents {
  /// There is a coarse stand-in, long before the session is ready.
  onPreview(session: Session): void;
  onReady(session: Session, missing: readonly string[]): void;
  /// The points of a file, which the server knows nothing of.
  onCloud(name: string, cloud: Cloud): void;
  onFailure(what: string, error: CurvecastError): void;
}

const stageWords: Record<string, string> = {
  queued: "waiting for its turn",
  load: "taken from the cache",
  read: "reading",
  repair: "repairing",
  cut: "cutting to discs",
  parameterise: "flattening",
  curve: "laying the curve",
  map: "finding the surface",
  area: "measuring areas",
  ranks: "ranking points",
};
const sendingShare = 0.3; // of the bar, for sending the files; the rest is for preparing the session
const dropLinger = 700; // ms; browsers send dragover every 350 ms at least while files are over the page

const filesKept = 8; // meshes whose files can be opened again

/// Takes files from anywhere on the page. Several uploads may run at once. Each has a bar, and can be cancelled.
export class Uploads {
  private readonly bars = element("div", { class: "uploads" });
  private readonly input = element("input");
  private readonly opened = new Map<string, { mesh: NamedFile; others: readonly NamedFile[] }>(); // by session, oldest first

  constructor(
    parent: HTMLElement,
    private readonly client: Client,
    private readonly events: UploadEvents,
  ) {
    this.input.type = "file";
    this.input.multiple = true;
    this.input.hidden = true;
    this.input.addEventListener("change", () => {
      void this.start([...(this.input.files ?? [])].map((file) => ({ name: file.name, data: file })));
      this.input.value = "";
    });
    parent.append(this.bars, this.input, element("div", { class: "drop" }));
    this.listen(parent);
  }

  /// Lets the user choose files.
  pick(): void {
    this.input.click();
  }

  /// Returns the name of the mesh that became a session on this page; null where its files are not known.
  nameOf(sessionId: string): string | null {
    return this.opened.get(sessionId)?.mesh.name ?? null;
  }

  /// Uploads the files of a session again. Precondition: nameOf() is not null.
  again(sessionId: string): void {
    const { mesh, others } = this.opened.get(sessionId)!;
    void this.run(mesh, others);
  }

  private async start(files: readonly NamedFile[]): Promise<void> {
    const cloud = await cloudAmong(files);
    if (cloud !== null) return this.read(cloud);
    const mesh = meshAmong(files);
    if (mesh === null) {
      const error = asCurvecastError(new Error("none of these files is a mesh or a point cloud"));
      return this.events.onFailure("Nothing to show", error);
    }
    return this.run(
      mesh,
      files.filter((file) => file !== mesh),
    );
  }

  private read(file: NamedFile): Promise<void> {
    return this.withBar(file.name, async (signal, show) => {
      const cloud = await openCloud(file, { signal, onProgress: show });
      this.events.onCloud(file.name, cloud);
    });
  }

  private run(mesh: NamedFile, others: readonly NamedFile[]): Promise<void> {
    return this.withBar(mesh.name, async (signal, show) => {
      const uploaded = await this.client.upload(mesh, others, {
        signal,
        onProgress: (sent, total, name) =>
          show(
            sendingShare * (sent / Math.max(1, total)),
            `sending ${name === mesh.name ? "" : name} ${bytes(sent)} of ${bytes(total)}`,
          ),
      });
      const session = await this.client.createSession({
        meshId: uploaded.meshId,
        companions: uploaded.companions,
        signal,
        onPreview: (preview) => this.events.onPreview(preview),
        onProgress: ({ stage, overall }) => {
          show(sendingShare + (1 - sendingShare) * overall, stageWords[stage] ?? stage);
        },
      });
      this.keep(session.sessionId, mesh, others);
      this.events.onReady(session, uploaded.missing);
    });
  }

  /// Shows a bar while a file is opened, with a button that aborts the signal.
  private async withBar(
    name: string,
    open: (signal: AbortSignal, show: (part: number, text: string) => void) => Promise<void>,
  ): Promise<void> {
    const stop = new AbortController();
    const bar = element("progress", { attributes: { "aria-label": name } });
    const words = element("span");
    const cancel = button("Cancel", () => stop.abort());
    const row = element("div", { class: "upload" }, [element("strong", { text: name }), bar, words, cancel]);
    this.bars.append(row);
    try {
      await open(stop.signal, (part, text) => {
        bar.value = part;
        words.textContent = text;
      });
    } catch (thrown) {
      const error = asCurvecastError(thrown);
      if (!stop.signal.aborted) this.events.onFailure(`${name} could not be opened`, error);
    } finally {
      row.remove();
    }
  }

  /// Browsers keep the files themselves: this takes no memory to speak of.
  private keep(sessionId: string, mesh: NamedFile, others: readonly NamedFile[]): void {
    this.opened.delete(sessionId);
    this.opened.set(sessionId, { mesh, others });
    const [oldest] = this.opened.keys();
    if (oldest !== undefined && this.opened.size > filesKept) this.opened.delete(oldest);
  }

  private listen(page: HTMLElement): void {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const showTarget = (isShown: boolean) => {
      clearTimeout(timer);
      page.classList.toggle("dropping", isShown);
      if (isShown) timer = setTimeout(() => showTarget(false), dropLinger);
    };
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") === true;
    window.addEventListener("dragover", (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      showTarget(true);
    });
    window.addEventListener("drop", (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      showTarget(false);
      droppedFiles(event.dataTransfer!).then(
        (files) => void this.start(files),
        (thrown: unknown) => this.events.onFailure("What was dropped cannot be read", asCurvecastError(thrown)),
      );
    });
  }
}
