/** What is wrong with an input, place by place. */
import { BinaryReader } from "@bufbuild/protobuf/wire";
import { ConnectError } from "@connectrpc/connect";

import type { Problem } from "../gen/d3dgen/v1/progress_pb";

export type Place = Pick<Problem, "path" | "message">;

/** Name and fields of the message in which a refusal says its places. */
const BAD_REQUEST = "google.rpc.BadRequest";
const VIOLATIONS = 1;
const FIELDS = { path: 1, message: 2 };

/** Returns the places of a refusal; none where it names none. */
export function placesOf(error: unknown): Place[] {
  return ConnectError.from(error).details.flatMap((detail) =>
    "type" in detail && detail.type === BAD_REQUEST && detail.value instanceof Uint8Array ? violations(detail.value) : [],
  );
}

function violations(bytes: Uint8Array): Place[] {
  const found: Place[] = [];
  fields(bytes, (number, reader) => number === VIOLATIONS && found.push(violation(reader.bytes())) > 0);
  return found;
}

function violation(bytes: Uint8Array): Place {
  const place = { path: "", message: "" };
  fields(bytes, (number, reader) => {
    if (number === FIELDS.path) place.path = reader.string();
    else if (number === FIELDS.message) place.message = reader.string();
    else return false;
    return true;
  });
  return place;
}

/** Goes through the fields of a message; what `take` does not take is skipped. */
function fields(bytes: Uint8Array, take: (number: number, reader: BinaryReader) => boolean) {
  const reader = new BinaryReader(bytes);
  while (reader.pos < reader.len) {
    const [number, type] = reader.tag();
    if (!take(number, reader)) reader.skip(type, number);
  }
}
