// SPDX-License-Identifier: Apache-2.0
// Asks for the surface of one session, once.

import { asCurvecastError, type CurvecastError, type SurfaceMesh } from "../stream";

/// Follows whether the surface is wanted. What has come stays, and so does a refusal.
export class SurfaceFollower {
  private asked: AbortController | null = null;
  private meshNow: SurfaceMesh | null = null;
  private refusalNow: CurvecastError | null = null;

  /// `onAnswer` is called once the surface has come, or was refused.
  constructor(
    private readonly ask: (options: { signal: AbortSignal }) => Promise<SurfaceMesh>,
    private readonly onAnswer: () => void,
  ) {}

  get mesh(): SurfaceMesh | null {
    return this.meshNow;
  }

  /// Why there is none, and will be none.
  get refusal(): CurvecastError | null {
    return this.refusalNow;
  }

  /// Whether the answer is to come.
  get isAsked(): boolean {
    return this.asked !== null;
  }

  follow(isWanted: boolean): void {
    if (!isWanted) return this.close();
    if (this.asked === null && this.meshNow === null && this.refusalNow === null) void this.request();
  }

  /// Ends a request, without a callback.
  close(): void {
    const { asked } = this;
    this.asked = null;
    asked?.abort();
  }

  private async request(): Promise<void> {
    const asked = (this.asked = new AbortController());
    let answer: SurfaceMesh | CurvecastError;
    try {
      answer = await this.ask({ signal: asked.signal });
    } catch (thrown) {
      answer = asCurvecastError(thrown);
    }
    if (this.asked !== asked) return; // no longer wanted
    this.asked = null;
    if (answer instanceof Error) this.refusalNow = answer;
    else this.meshNow = answer;
    this.onAnswer();
  }
}
