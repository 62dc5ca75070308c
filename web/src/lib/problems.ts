/** What a refusal says beside its words: its reason, and what is wrong with an input, place by place. */
import { BinaryReader } from "@bufbuild/protobuf/wire";
import { ConnectError } from "@connectrpc/connect";

import type { Problem } from "../gen/d3dgen/v1/progress_pb";

export type Place = Pick<Problem, "path" | "message">;

/** What a reason is about, by names that stay. */
export type Facts = Record<string, string | undefined>;

/** Name and fields of the message in which a refusal gives its reason, and of an entry of what it is about. */
const ERROR_INFO = "google.rpc.ErrorInfo";
const INFO = { reason: 1, metadata: 3 };
const ENTRY = { key: 1, value: 2 };
/** Name and fields of the message in which a refusal says its places. */
const BAD_REQUEST = "google.rpc.BadRequest";
const VIOLATIONS = 1;
const FIELDS = { path: 1, message: 2 };

/** Returns the places of a refusal; none where it names none. */
export function placesOf(error: unknown): Place[] {
  return detailsOf(error, BAD_REQUEST).flatMap(violations);
}

/** Returns the reason of a refusal, and what is to be known of it; an empty one where there is none. */
export function reasonIn(error: unknown): { reason: string; facts: Facts } {
  const found = { reason: "", facts: {} as Facts };
  for (const bytes of detailsOf(error, ERROR_INFO)) {
    fields(bytes, (number, reader) => {
      if (number === INFO.reason) found.reason = reader.string();
      else if (number === INFO.metadata) found.facts = { ...found.facts, ...entry(reader.bytes()) };
      else return false;
      return true;
    });
  }
  return found;
}

function detailsOf(error: unknown, type: string): Uint8Array[] {
  const { details } = ConnectError.from(error);
  return details.flatMap((d) => ("type" in d && d.type === type && d.value instanceof Uint8Array ? [d.value] : []));
}

function entry(bytes: Uint8Array): Facts {
  let [key, value] = ["", ""];
  fields(bytes, (number, reader) => {
    if (number === ENTRY.key) key = reader.string();
    else if (number === ENTRY.value) value = reader.string();
    else return false;
    return true;
  });
  return { [key]: value };
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
