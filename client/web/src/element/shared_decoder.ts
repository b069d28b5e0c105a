// SPDX-License-Identifier: Apache-2.0
// One decoder for all elements of a page: its threads are there while there is an element.

import { WorkerDecoder } from "../stream";

let shared: { decoder: WorkerDecoder; users: number } | null = null;

/// Returns the page's decoder. Its threads end with the last releaseDecoder().
export function takeDecoder(): WorkerDecoder {
  shared ??= { decoder: new WorkerDecoder(), users: 0 };
  shared.users += 1;
  return shared.decoder;
}

/// To be called once for each takeDecoder().
export function releaseDecoder(): void {
  if (shared === null || --shared.users > 0) return;
  shared.decoder.close();
  shared = null;
}
