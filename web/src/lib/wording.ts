/** What ids are called in a language, and what sentences say: data in `texts/`, one file a language; ids are English words already. */
import { compiled, type Patterns } from "./sentences";

/**
 * What has ids: kinds of building with what they are for, kinds of rooms, things, people and robots, hard rules, and what
 * rules measure.
 */
export type Subject = "buildings" | "about" | "rooms" | "objects" | "roles" | "robots" | "rules" | "measures";
export type Wording = Record<Subject, Record<string, string>>;

const NONE: Wording = { buildings: {}, about: {}, rooms: {}, objects: {}, roles: {}, robots: {}, rules: {}, measures: {} };
const FILES = import.meta.glob<Wording>("../texts/names/*.json", { import: "default" });

const SENTENCES = import.meta.glob<Record<string, string>>("../texts/sentences/*.json", { import: "default" });

/** Returns what the server's English sentences say in a language; nothing for one without a file. */
export async function patternsOf(language: string): Promise<Patterns> {
  return compiled((await SENTENCES[`../texts/sentences/${language}.json`]?.()) ?? {});
}

/** Returns what ids are called; nothing for a language without a file. */
export async function wordingOf(language: string): Promise<Wording> {
  return (await FILES[`../texts/names/${language}.json`]?.()) ?? NONE;
}
