/** Facts that are asked for: what of each a person can change, and what it says in words. */
import { clone, create } from "@bufbuild/protobuf";

import {
  AskedCountSchema,
  Bound,
  type Fact,
  FactSchema,
  PlaceKind,
  RelationKind,
  type Subject,
  SubjectSchema,
} from "../gen/d3dgen/v1/brief_pb";
import { figure, levelName, t, type TextKey, words } from "./texts.svelte";

/** What of a fact can be changed; a part that a fact of its kind does not have is absent. */
export interface Wish {
  /** What it is about: a kind of room or of thing. */
  subject?: { of: "room" | "object"; id: string; name: string };
  /** How many, and how that binds; no number where none was said. */
  count?: { n: number | undefined; bound: Bound };
  /** Floor area, m2. */
  area?: { m2: number | undefined };
  /** Storey, 0 at the ground. */
  level?: { at: number | undefined };
}

type FactKind = Exclude<Fact["kind"]["case"], undefined>;

/** Which parts facts of each kind have; `rooms` is a number of rooms in all. */
const PARTS: Record<FactKind, { subject?: "room" | "object"; parts?: ("count" | "area" | "level" | "total")[] }> = {
  rooms: { subject: "room", parts: ["count", "area", "level"] },
  objects: { subject: "object", parts: ["count"] },
  capacity: { parts: ["count"] },
  storeys: { parts: ["count"] },
  area: { parts: ["area"] },
  robots: { parts: ["count"] },
  people: { parts: ["count"] },
  only: { parts: ["total"] },
  relation: {},
  style: {},
  accessible: {},
  forbidden: {},
  site: {},
  other: {},
};

/** The fields that facts of several kinds share. */
interface Loose {
  room?: Subject;
  object?: Subject;
  within?: Subject;
  a?: Subject;
  b?: Subject;
  count?: { n: number; bound?: Bound };
  bound?: Bound;
  areaM2?: number;
  level?: number;
  rooms?: number;
  of?: PlaceKind;
  relation?: RelationKind;
  kind?: string | number;
  role?: string;
  word?: string;
  wish?: string;
}

const loose = (fact: Fact | undefined) => fact?.kind.value as unknown as Loose | undefined;

/** Returns what of a fact can be changed, as it is. */
export function wishOf(fact: Fact | undefined): Wish {
  const value = loose(fact);
  if (!fact?.kind.case || !value) return {};
  const { subject, parts = [] } = PARTS[fact.kind.case];
  const named = subject && value[subject];
  const has = (part: (typeof parts)[number]) => parts.includes(part);
  const bound = value.count?.bound ?? value.bound ?? Bound.UNSPECIFIED;
  return {
    subject: subject && { of: subject, id: named?.id ?? "", name: named?.name ?? "" },
    count: has("count") || has("total") ? { n: has("total") ? value.rooms : value.count?.n, bound } : undefined,
    area: has("area") ? { m2: value.areaM2 } : undefined,
    level: has("level") ? { at: value.level } : undefined,
  };
}

/** Returns a fact with a wish in it; figures that a fact cannot be without stay where the wish has none. */
export function factOf(fact: Fact, wish: Wish): Fact {
  const next = clone(FactSchema, fact);
  const value = loose(next);
  if (!next.kind.case || !value) return next;
  const { parts = [] } = PARTS[next.kind.case];
  if (wish.subject) value[wish.subject.of] = create(SubjectSchema, { id: wish.subject.id || undefined, name: wish.subject.name });
  if (parts.includes("total")) value.rooms = wish.count?.n;
  else if (wish.count?.n) value.count = create(AskedCountSchema, { n: wish.count.n, bound: wish.count.bound || undefined });
  else if (next.kind.case === "rooms" || next.kind.case === "objects") value.count = undefined;
  if (wish.area && (wish.area.m2 || next.kind.case === "rooms")) value.areaM2 = wish.area.m2 || undefined;
  if (wish.level) value.level = wish.level.at;
  return next;
}

/** Returns a new fact about rooms or things of a kind. */
export function newFact(subject: NonNullable<Wish["subject"]>, n: number): Fact {
  const value = { [subject.of]: { id: subject.id, name: subject.name }, count: { n } };
  return create(FactSchema, { kind: { case: subject.of === "room" ? "rooms" : "objects", value } as never });
}

const BOUNDS: Partial<Record<Bound, TextKey>> = {
  [Bound.AT_LEAST]: "bound.atLeast",
  [Bound.AT_MOST]: "bound.atMost",
  [Bound.ABOUT]: "bound.about",
};
const PLACES: Record<PlaceKind, TextKey> = {
  [PlaceKind.UNSPECIFIED]: "place.any",
  [PlaceKind.SEATS]: "place.seats",
  [PlaceKind.DESKS]: "place.desks",
  [PlaceKind.BEDS]: "place.beds",
  [PlaceKind.CARS]: "place.cars",
  [PlaceKind.BICYCLES]: "place.bicycles",
  [PlaceKind.DOCKS]: "place.docks",
  [PlaceKind.ANIMALS]: "place.animals",
  [PlaceKind.COUNTERS]: "place.counters",
  [PlaceKind.TREATMENT]: "place.treatment",
  [PlaceKind.PALLETS]: "place.pallets",
};
const RELATIONS: Record<RelationKind, TextKey> = {
  [RelationKind.UNSPECIFIED]: "relation.nextTo",
  [RelationKind.NEXT_TO]: "relation.nextTo",
  [RelationKind.DOOR]: "relation.door",
  [RelationKind.OPEN_TO]: "relation.openTo",
  [RelationKind.ONLY_FROM]: "relation.onlyFrom",
  [RelationKind.NOT_FROM]: "relation.notFrom",
  [RelationKind.AWAY_FROM]: "relation.awayFrom",
  [RelationKind.SEES]: "relation.sees",
  [RelationKind.FACES]: "relation.faces",
  [RelationKind.ABOVE]: "relation.above",
  [RelationKind.BETWEEN]: "relation.between",
};

/** Returns the name of a kind of fact. */
export function kindName(fact: Fact | undefined): string {
  return fact?.kind.case ? t(`fact.${fact.kind.case}`) : "";
}

/** Returns what a fact says, for people: `at least 3 bedrooms · 20 m² · Floor 1`. */
export function factSaid(fact: Fact | undefined): string {
  const value = loose(fact);
  if (!fact?.kind.case || !value) return "";
  const { count, area, level } = wishOf(fact);
  const bound = count && BOUNDS[count.bound];
  const number = count?.n ? [bound && t(bound), figure(count.n)].filter(Boolean).join(" ") : "";
  const what = subjectOf(fact, value);
  const parts = [
    [number, what].filter(Boolean).join(" "),
    area?.m2 ? `${figure(area.m2)} m²` : "",
    level?.at === undefined ? "" : levelName(level.at),
    fact.kind.case !== "rooms" && fact.kind.case !== "forbidden" && value.room && what !== value.room.name ? value.room.name : "",
  ];
  return parts.filter(Boolean).join(" · ");
}

function subjectOf(fact: Fact, value: Loose): string {
  switch (fact.kind.case) {
    case "relation":
      return [value.a?.name, t(RELATIONS[value.relation ?? RelationKind.UNSPECIFIED]), value.b?.name].filter(Boolean).join(" ");
    case "capacity":
      return t(PLACES[value.of ?? PlaceKind.UNSPECIFIED]);
    case "storeys":
      return t("fact.storeys");
    case "only":
      return value.rooms === undefined ? "" : t("fact.rooms");
    default:
      return openWord(value);
  }
}

/** Returns the open word of a fact: what a room, a thing, a role or a manner is called. */
function openWord(value: Loose): string {
  const kind = typeof value.kind === "string" ? value.kind : undefined;
  return words(value.object?.name ?? value.room?.name ?? kind ?? value.role ?? value.word ?? value.wish ?? "");
}
