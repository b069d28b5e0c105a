import type { JsonObject } from "@bufbuild/protobuf";

export type Row = [id: number, rung: number];

/// As described in make_point_edits.mjs.
export interface PointEditsCase {
  name: string;
  before: Row[];
  edits: JsonObject;
  fresh: Row[];
  after: Row[] | null;
}

export function pointEditsCases(): PointEditsCase[];
