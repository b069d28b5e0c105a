// SPDX-License-Identifier: Apache-2.0
// Repeats calls that failed because the network did.

import { Backoff } from "./backoff";
import { now } from "./clock";
import { asCurvecastError, cancelled } from "./errors";

const firstDelay = 0.1; // seconds
const longestDelay = 5; // seconds
const giveUpAfter = 60; // seconds of failures in a row

/// Calls `attempt` until it succeeds, fails otherwise than with UNAVAILABLE, or has failed for a minute. An attempt that calls
/// `resetFailures` has heard the server, and its failure begins a new minute. Rejects with the error of the last attempt, or CANCELLED.
export async function repeat<T>(attempt: (resetFailures: () => void) => Promise<T>, signal?: AbortSignal): Promise<T> {
  const backoff = new Backoff(firstDelay, longestDelay);
  let failing: number | null = null; // when the first failure of the row was
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

/// Waits. Rejects with CANCELLED as soon as `signal` is aborted.
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
