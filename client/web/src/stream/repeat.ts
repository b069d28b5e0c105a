// Repeats what the network has spoilt.

import { Backoff } from "./backoff";
import { now } from "./clock";
import { asCurvecastError, cancelled } from "./errors";

const firstDelay = 0.1; // seconds, and so are those below
const longestDelay = 5;
const giveUpAfter = 60; // of failures in a row

/// Calls `attempt` until it succeeds, fails otherwise than with UNAVAILABLE, or has failed for a minute. `resetFailures`: the server
/// was heard, so that a failure is the first of a new row. Throws a CurvecastError: that of the last attempt, or CANCELLED.
export async function repeat<T>(attempt: (resetFailures: () => void) => Promise<T>, signal?: AbortSignal): Promise<T> {
  const backoff = new Backoff(firstDelay, longestDelay);
  let failing: number | null = null; // since
  while (true) {
    try {
      return await attempt(() => (failing = null));
    } catch (thrown) {
      const error = asCurvecastError(thrown);
      failing ??= now();
      const delay = Math.max(backoff.next(), error.retryAfter ?? 0);
      if (error.code !== "UNAVAILABLE" || now() + delay - failing > giveUpAfter) throw error;
      await sleep(delay, signal);
    }
  }
}

/// Throws CANCELLED as soon as `signal` is aborted.
function sleep(seconds: number, signal: AbortSignal | undefined): Promise<void> {
  return new Promise((resolve, reject) => {
    const abort = () => {
      clearTimeout(timer);
      reject(cancelled());
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener("abort", abort);
      resolve();
    }, 1000 * seconds);
    if (signal?.aborted) abort();
    else signal?.addEventListener("abort", abort, { once: true });
  });
}
