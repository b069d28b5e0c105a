import { create } from "@bufbuild/protobuf";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";

import { SessionChoice } from "../../../../client/web/src/app/session_choice";
import { SessionSchema, SessionState, type Session } from "../../../../client/web/src/gen/curvecast/v1/curvecast_pb";
import { CurvecastError, type ErrorCode } from "../../../../client/web/src/stream/errors";
import type { CameraState } from "../../../../client/web/src/view/types";

const camera: CameraState = { eye: [0, 0, 5], target: [0, 0, 0], up: [0, 1, 0], fov: 30 };
const error = (code: ErrorCode) => new CurvecastError(code, code.toLowerCase());

function session(id: string, state = SessionState.READY): Session {
  return create(SessionSchema, { sessionId: id, meshId: `mesh_${id}`, state });
}

/// Answers as the test says; what is asked, and what the choice tells, is noted.
class Page {
  isVisible = true;
  sessions: () => Promise<Session[]> = async () => [];
  readonly known = new Map<string, () => Promise<Session>>();
  lists = 0;
  asked: string[] = [];
  told: string[] = [];
  banner: string | null = null;
  readonly choice = new SessionChoice(
    {
      listSessions: () => ((this.lists += 1), this.sessions()),
      getSession: (id) => (this.asked.push(id), (this.known.get(id) ?? (() => Promise.reject(error("NOT_FOUND"))))()),
    },
    {
      onSessions: () => {},
      onReady: ({ sessionId }, from) => this.told.push(`show ${sessionId}${from === null ? "" : " from there"}`),
      onNone: () => this.told.push("none"),
      onWaiting: (text) => (this.banner = text),
      onFailure: (id, { code }) => this.told.push(`${id}: ${code}`),
      onRefused: ({ code }) => this.told.push(code),
    },
    () => this.isVisible,
  );

  knows(...ids: string[]): void {
    for (const id of ids) this.known.set(id, async () => session(id));
    this.sessions = async () => ids.map((id) => session(id));
  }

  /// With the address's session.
  async open(id: string | null): Promise<void> {
    const { known } = this;
    const answer = id === null ? null : (known.get(id) ?? (() => Promise.reject(error("NOT_FOUND"))))();
    answer?.catch(() => {});
    this.choice.start({ sessions: this.sessions(), session: answer }, id, id === null ? null : camera);
    await this.pass(0);
  }

  async pass(seconds: number): Promise<void> {
    await vi.advanceTimersByTimeAsync(1000 * seconds);
  }

  /// What was told since the last call.
  take(): string[] {
    return this.told.splice(0);
  }
}

let page: Page;
beforeEach(() => {
  vi.useFakeTimers();
  page = new Page();
});
afterEach(() => vi.useRealTimers());

const unavailable = () => Promise.reject(error("UNAVAILABLE"));

describe("the address's session", () => {
  it("is shown with its camera, by the first answers alone", async () => {
    page.knows("a", "b");
    await page.open("b");
    expect(page.take()).toEqual(["show b from there"]);
    expect(page.asked).toEqual([]);
    await page.pass(20);
    expect(page.take()).toEqual([]);
  });

  it("is waited for while it is prepared", async () => {
    page.knows("a", "b");
    page.known.set("b", async () => session("b", SessionState.PREPROCESSING));
    await page.open("b");
    expect(page.banner).toBe("mesh_b is being prepared …");
    await page.pass(3);
    expect(page.asked).toEqual(["b", "b", "b"]);
    page.known.set("b", async () => session("b"));
    await page.pass(1);
    expect(page.take()).toEqual(["show b from there"]);
    expect(page.banner).toBeNull();
    await page.pass(20);
    expect(page.asked.length).toBe(4);
  });

  it("is waited for no more once the page shows something else, until one is chosen", async () => {
    page.knows("a", "b");
    page.known.set("b", async () => session("b", SessionState.PREPROCESSING));
    await page.open("b");
    page.choice.rest();
    expect(page.banner).toBeNull();
    page.known.set("b", async () => session("b"));
    await page.pass(20);
    expect(page.take()).toEqual([]);
    page.choice.choose("a");
    await page.pass(0);
    expect(page.take()[0]).toMatch(/^show a/);
  });

  it("is waited for while the server cannot be reached", async () => {
    page.known.set("b", unavailable);
    page.sessions = unavailable;
    await page.open("b");
    expect(page.banner).toBe("unavailable. Trying again …");
    await page.pass(4.5);
    expect(page.asked.length).toBe(2);
    page.knows("a", "b");
    await page.pass(2);
    expect(page.take()).toEqual(["show b from there"]);
    expect(page.banner).toBeNull();
  });

  it("is told of where it is not there, and no other is shown before the user chooses", async () => {
    page.knows("a");
    await page.open("gone");
    expect(page.take()).toEqual(["gone: NOT_FOUND"]);
    await page.pass(30);
    expect(page.take()).toEqual([]);
    expect(page.lists).toBeGreaterThan(4);
    page.choice.choose("a");
    await page.pass(0);
    expect(page.take()).toEqual(["show a"]);
  });
});

describe("without a session in the address", () => {
  it("the first that is ready is shown, once", async () => {
    page.knows("a", "b");
    page.sessions = async () => [session("x", SessionState.QUEUED), session("b")];
    await page.open(null);
    expect(page.take()).toEqual(["show b"]);
    await page.pass(20);
    expect(page.take()).toEqual([]);
  });

  it("there is an invitation until there is one", async () => {
    await page.open(null);
    await page.pass(5);
    expect(page.take()).toEqual(["none", "none"]);
    page.knows("a");
    await page.pass(5);
    expect(page.take()).toEqual(["show a"]);
  });

  it("a server that cannot be reached is tried again every two seconds", async () => {
    page.sessions = unavailable;
    await page.open(null);
    expect(page.banner).toBe("unavailable. Trying again …");
    await page.pass(4);
    expect(page.lists).toBe(2);
    page.knows("a");
    await page.pass(2);
    expect(page.take()).toEqual(["show a"]);
    expect(page.banner).toBeNull();
  });
});

describe("a choice", () => {
  beforeEach(async () => {
    page.knows("a", "b", "c");
    await page.open("a");
    page.take();
  });

  it("is tried until the server is there, also while another session is shown", async () => {
    page.known.set("b", unavailable);
    page.choice.choose("b");
    await page.pass(4);
    expect(page.banner).toBe("unavailable. Trying again …");
    page.known.set("b", async () => session("b"));
    await page.pass(2);
    expect(page.take()).toEqual(["show b"]);
    expect(page.banner).toBeNull();
    const { lists } = page;
    await page.pass(10);
    expect(page.lists).toBe(lists + 2);
  });

  it("takes the place of the one before, whose timer and answer no longer count", async () => {
    page.known.set("b", async () => session("b", SessionState.QUEUED));
    page.choice.choose("b");
    await page.pass(0);
    expect(page.banner).toBe("mesh_b is being prepared …");
    page.choice.choose("gone");
    expect(page.banner).toBeNull();
    await page.pass(0);
    expect(page.take()).toEqual(["gone: NOT_FOUND"]);
    await page.pass(10);
    expect(page.asked).toEqual(["b", "gone"]);
    let late = (_: Session) => {};
    page.known.set("b", () => new Promise((resolve) => (late = resolve)));
    page.choice.choose("b");
    page.choice.choose("c");
    await page.pass(0);
    late(session("b"));
    await page.pass(10);
    expect(page.take()).toEqual(["show c"]);
  });

  it("that fails for good leaves the list alive", async () => {
    page.known.set("b", () => Promise.reject(error("INTERNAL")));
    page.choice.choose("b");
    await page.pass(0);
    expect(page.take()).toEqual(["b: INTERNAL"]);
    const { lists } = page;
    await page.pass(10);
    expect(page.lists).toBe(lists + 2);
    expect(page.asked).toEqual(["b"]);
  });
});

describe("the list", () => {
  it("is asked for every five seconds while the page is visible", async () => {
    page.knows("a");
    await page.open(null);
    await page.pass(10);
    expect(page.lists).toBe(2);
    page.isVisible = false;
    await page.pass(20);
    expect(page.lists).toBe(2);
    page.isVisible = true;
    await page.pass(5);
    expect(page.lists).toBe(3);
    page.choice.refresh();
    page.choice.refresh();
    await page.pass(4);
    expect(page.lists).toBe(5);
    await page.pass(1);
    expect(page.lists).toBe(6);
  });

  it("goes on where the server is lost behind a session that is shown, without a banner", async () => {
    page.knows("a");
    await page.open(null);
    page.sessions = unavailable;
    await page.pass(10);
    expect(page.banner).toBeNull();
    expect(page.lists).toBe(2);
  });

  it.each(["UNAUTHENTICATED", "PERMISSION_DENIED"] as const)("ends after %s, as the question for a session does", async (code) => {
    page.sessions = () => Promise.reject(error(code));
    page.known.set("a", unavailable);
    await page.open("a");
    expect(page.take()).toEqual([code]);
    expect(page.banner).toBeNull();
    page.choice.refresh();
    await page.pass(30);
    expect([page.lists, page.asked, page.take()]).toEqual([0, [], []]);
  });
});
