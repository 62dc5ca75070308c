/** What was understood of a sentence, as stretches of its words. */
import { equals } from "@bufbuild/protobuf";

import { type Ask, type Brief, BriefSchema, type PromptWords } from "../gen/d3dgen/v1/brief_pb";
import { Fate, type Report } from "../gen/d3dgen/v1/report_pb";
import type { World } from "../gen/d3dgen/v1/world_pb";
import { factSaid, kindName } from "./facts";
import { t } from "./texts.svelte";

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
