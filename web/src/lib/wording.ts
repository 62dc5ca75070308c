/** What ids are called in a language: data in `texts/names/`, one file a language; ids are English words already. */

/**
 * What has ids: kinds of building with what they are for, kinds of rooms, things, people and robots, hard rules, and what
 * rules measure.
 */
export type Subject = "buildings" | "about" | "rooms" | "objects" | "roles" | "robots" | "rules" | "measures";
export type Wording = Record<Subject, Record<string, string>>;

const NONE: Wording = { buildings: {}, about: {}, rooms: {}, objects: {}, roles: {}, robots: {}, rules: {}, measures: {} };
const FILES = import.meta.glob<Wording>("../texts/names/*.json", { import: "default" });

/** Returns what ids are called; nothing for a language without a file. */
export async function wordingOf(language: string): Promise<Wording> {
  return (await FILES[`../texts/names/${language}.json`]?.()) ?? NONE;
}
