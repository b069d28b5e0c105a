// Makes sessions of files that the user drops or chooses.

import { asCurvecastError, meshAmong, type Client, type CurvecastError, type NamedFile, type Session } from "../stream";
import { droppedFiles } from "./dropped_files";
import { button, element } from "./elements";
import { bytes } from "./format";

/// The outcomes of an upload.
export interface UploadEvents {
  /// There is a coarse stand-in, long before the session is ready.
  onPreview(session: Session): void;
  onReady(session: Session, missing: readonly string[]): void;
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
      this.start([...(this.input.files ?? [])].map((file) => ({ name: file.name, data: file })));
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

  private start(files: readonly NamedFile[]): void {
    const mesh = meshAmong(files);
    if (mesh === null) {
      const error = asCurvecastError(new Error("none of these files is a mesh: PLY, OBJ, OFF, STL, glTF or GLB"));
      return this.events.onFailure("Nothing to show", error);
    }
    void this.run(
      mesh,
      files.filter((file) => file !== mesh),
    );
  }

  private async run(mesh: NamedFile, others: readonly NamedFile[]): Promise<void> {
    const stop = new AbortController();
    const bar = element("progress", { attributes: { "aria-label": mesh.name } });
    const words = element("span");
    const row = element("div", { class: "upload" }, [
      element("strong", { text: mesh.name }),
      bar,
      words,
      button("Cancel", () => stop.abort()),
    ]);
    this.bars.append(row);
    const show = (part: number, text: string) => {
      bar.value = part;
      words.textContent = text;
    };
    try {
      const uploaded = await this.client.upload(mesh, others, {
        signal: stop.signal,
        onProgress: (sent, total, name) =>
          show(
            sendingShare * (sent / Math.max(1, total)),
            `sending ${name === mesh.name ? "" : name} ${bytes(sent)} of ${bytes(total)}`,
          ),
      });
      const session = await this.client.createSession({
        meshId: uploaded.meshId,
        companions: uploaded.companions,
        signal: stop.signal,
        onPreview: (preview) => this.events.onPreview(preview),
        onProgress: ({ stage, overall }) => {
          show(sendingShare + (1 - sendingShare) * overall, stageWords[stage] ?? stage);
        },
      });
      this.keep(session.sessionId, mesh, others);
      this.events.onReady(session, uploaded.missing);
    } catch (thrown) {
      const error = asCurvecastError(thrown);
      if (!stop.signal.aborted) this.events.onFailure(`${mesh.name} could not be opened`, error);
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
        (files) => this.start(files),
        (thrown: unknown) => this.events.onFailure("What was dropped cannot be read", asCurvecastError(thrown)),
      );
    });
  }
}
