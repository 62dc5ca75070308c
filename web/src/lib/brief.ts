/** What was understood of a sentence, as stretches of its words. */
import type { Ask, Brief, PromptWords } from "../gen/d3dgen/v1/brief_pb";
import { Fate, type Report } from "../gen/d3dgen/v1/report_pb";
import { session } from "./session.svelte";
import { t, words } from "./texts.svelte";

/** A stretch of the prompt; `about` says what it was read as, and is empty for mere grammar. */
export interface Chip {
  start: number;
  end: number;
  text: string;
  about: string;
  fate: "" | "met" | "unmet" | "unread";
}

/** Returns what a fact says, for people. */
function about(ask: Ask): string {
  const fact = ask.fact?.kind;
  if (!fact?.case) return "";
  const value = fact.value as unknown as Record<string, { n?: number; name?: string } | string | number | undefined>;
  const parts = [words(kebab(fact.case))];
  const count = typeof value.count === "object" ? value.count.n : value.rooms;
  if (typeof count === "number") parts.push(String(count));
  for (const name of ["room", "object", "kind", "role", "word", "wish"]) {
    const part = value[name];
    const text = typeof part === "object" ? part.name : part;
    if (typeof text === "string" && text) parts.push(words(text));
  }
  return parts.join(" · ");
}

const kebab = (name: string) => name.replace(/[A-Z]/g, (c) => `_${c.toLowerCase()}`);

function fateOf(report: Report | undefined, id: string): Chip["fate"] {
  const answer = report?.asks.find((a) => a.askId === id);
  return !answer ? "" : answer.fate === Fate.HONORED ? "met" : "unmet";
}

/** Returns the whole prompt as chips and the words between them, in order. */
export function chipsOf(brief: Brief): Chip[] {
  const letters = Array.from(brief.prompt);
  const found: Chip[] = [];
  const add = (all: PromptWords[], said: string, fate: Chip["fate"]) => {
    for (const { start, end } of all) found.push({ start, end, text: "", about: said, fate });
  };
  const building = brief.building;
  if (building) add(building.words, t("brief.building", { name: building.name }), "met");
  if (brief.place) add(brief.place.words, t("brief.place", { code: brief.place.divisionCode ?? brief.place.countryCode }), "met");
  for (const ask of brief.asks) add(ask.words, about(ask), fateOf(session.step?.report, ask.id));
  add(brief.notUnderstood, t("brief.unread"), "unread");
  found.sort((a, b) => a.start - b.start || b.end - a.end);
  const chips: Chip[] = [];
  let at = 0;
  for (const chip of found) {
    if (chip.start < at) continue;
    if (chip.start > at) chips.push({ start: at, end: chip.start, text: "", about: "", fate: "" });
    chips.push(chip);
    at = chip.end;
  }
  if (at < letters.length) chips.push({ start: at, end: letters.length, text: "", about: "", fate: "" });
  return chips.map((chip) => ({ ...chip, text: letters.slice(chip.start, chip.end).join("") }));
}

/** Returns the prompt with other words in place of a chip's. */
export function replaced(prompt: string, chip: Chip, text: string): string {
  const letters = Array.from(prompt);
  const whole = letters.slice(0, chip.start).join("") + text + letters.slice(chip.end).join("");
  return whole.replace(/ {2,}/g, " ").trim();
}
