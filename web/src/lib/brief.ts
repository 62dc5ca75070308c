/** What was understood of a sentence, as stretches of its words, and what of a fact a person can change. */
import { clone, create, equals } from "@bufbuild/protobuf";

import {
  type Ask,
  AskedCountSchema,
  Bound,
  type Brief,
  BriefSchema,
  type Fact,
  FactSchema,
  PlaceKind,
  type PromptWords,
  RelationKind,
  type Subject,
  SubjectSchema,
} from "../gen/d3dgen/v1/brief_pb";
import { Fate, type Report } from "../gen/d3dgen/v1/report_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { figure, levelName, t, type TextKey, words } from "./texts.svelte";

/** A stretch of the prompt; `about` says what it was read as, and is empty for mere grammar. */
export interface Chip {
  start: number;
  end: number;
  text: string;
  about: string;
  fate: "" | "met" | "unmet" | "unread" | "off";
  /** The facts that these words state, the nearest one first. */
  asks: Ask[];
}

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

/** A stretch of words and what they say. */
interface Mark extends Pick<Chip, "about" | "fate"> {
  words: PromptWords[];
  ask?: Ask;
}

function marksOf(brief: Brief, removed: Ask[], report: Report | undefined): Mark[] {
  const fate = (ask: Ask): Chip["fate"] => {
    const answer = report?.asks.find((a) => a.askId === ask.id);
    return !answer ? "" : answer.fate === Fate.HONORED ? "met" : "unmet";
  };
  const said = (ask: Ask) => `${kindName(ask.fact)}: ${factSaid(ask.fact)}`;
  const marks: Mark[] = brief.asks.map((ask) => ({ words: ask.words, about: said(ask), fate: fate(ask), ask }));
  marks.push(...removed.map((ask): Mark => ({ words: ask.words, about: t("brief.off"), fate: "off", ask })));
  const { building, place } = brief;
  if (building) marks.push({ words: building.words, about: t("brief.building", { name: building.name }), fate: "met" });
  if (place) marks.push({ words: place.words, about: t("brief.place", { code: place.divisionCode ?? place.countryCode }), fate: "met" });
  marks.push({ words: brief.notUnderstood, about: t("brief.unread"), fate: "unread" });
  return marks;
}

/** Shortest stretch that is worth a chip where its fact has others, characters. */
const LEAST = 3;

/**
 * Returns the whole prompt as chips and the words between them, in order. Where facts share words, these belong to the fact
 * that says the least beside them, and the chip tells of all.
 */
export function chipsOf(brief: Brief, removed: Ask[] = [], report?: Report): Chip[] {
  const letters = Array.from(brief.prompt);
  const marks = marksOf(brief, removed, report);
  const owners: (Mark | undefined)[] = letters.map(() => undefined);
  const size = (mark: Mark) => mark.words.reduce((sum, w) => sum + w.end - w.start, 0);
  for (const mark of marks.sort((a, b) => size(b) - size(a))) {
    for (const { start, end } of mark.words) owners.fill(mark, start, end);
  }
  const chips: Chip[] = [];
  const plain = (start: number, end: number) => {
    if (end > start) chips.push({ start, end, text: "", about: "", fate: "", asks: [] });
  };
  for (let start = 0, end: number; start < letters.length; start = end) {
    const mark = owners[start];
    for (end = start + 1; end < letters.length && owners[end] === mark; end++);
    const [from, to] = mark ? trimmed(letters, start, end) : [end, end];
    const isChip = mark && (to - from >= LEAST || size(mark) <= end - start);
    plain(start, isChip ? from : end);
    if (!isChip) continue;
    const asks = marks.filter((m) => m.words.some((w) => w.start < to && from < w.end)).flatMap((m) => m.ask ?? []);
    chips.push({ start: from, end: to, text: "", about: mark.about, fate: mark.fate, asks: asks.reverse() });
    plain(to, end);
  }
  return chips.map((chip) => ({ ...chip, text: letters.slice(chip.start, chip.end).join("") }));
}

/** Returns a stretch without what is no letter and no figure at its ends. */
function trimmed(letters: string[], start: number, end: number): [number, number] {
  const isWord = (letter: string) => /[\p{L}\p{N}]/u.test(letter);
  let [from, to] = [start, end];
  while (from < to && !isWord(letters[from])) from++;
  while (to > from && !isWord(letters[to - 1])) to--;
  return [from, to];
}

/** Returns the prompt with other words in place of a chip's. */
export function replaced(prompt: string, chip: Chip, text: string): string {
  const letters = Array.from(prompt);
  const whole = letters.slice(0, chip.start).join("") + text + letters.slice(chip.end).join("");
  return whole.replace(/ {2,}/g, " ").replace(/ +([,.;:])/g, "$1").trim();
}

/** Returns the verdict on a world where it answers to this brief. */
export function verdictOn(brief: Brief, step: { world: World; report: Report } | undefined): Report | undefined {
  return step?.world.brief && equals(BriefSchema, step.world.brief, brief) ? step.report : undefined;
}
