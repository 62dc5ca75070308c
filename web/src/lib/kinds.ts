/** The kinds of room and of thing that a domain knows, by their names in the reader's language; asked for once each. */
import { domains } from "./api";
import { texts } from "./texts.svelte";
import { wordingOf } from "./wording";

export interface Kind {
  id: string;
  name: string;
  /** Its English name, which rooms are called by. */
  label: string;
}

export interface Kinds {
  room: Kind[];
  object: Kind[];
}

type Named = { label: string; keywords: { [language: string]: { items: string[] } } };
const known = new Map<string, Promise<Kinds>>();

/** Returns the kinds of a domain by name; none where the server does not know it. */
export function kindsOf(domainId: string): Promise<Kinds> {
  const name = `${domainId} ${texts.language}`;
  let found = known.get(name);
  if (!found) {
    found = load(domainId, texts.language);
    found.catch(() => known.delete(name));
    known.set(name, found);
  }
  return found;
}

async function load(domainId: string, language: string): Promise<Kinds> {
  const [{ manifest }, wording] = await Promise.all([domains.getDomain({ domainId, includeManifest: true }), wordingOf(language)]);
  const named = (one: Named, own: string | undefined) =>
    language === "en" ? one.label : (own ?? capital(one.keywords[language]?.items[0] ?? one.label, language));
  const sorted = (all: Kind[]) => all.sort((a, b) => a.name.localeCompare(b.name, language));
  return {
    room: sorted((manifest?.roomTypes ?? []).map((r) => ({ id: r.roomTypeId, label: r.label, name: named(r, wording.rooms[r.roomTypeId]) }))),
    object: sorted((manifest?.objects ?? []).map((o) => ({ id: o.objectId, label: o.label, name: named(o, wording.objects[o.objectId]) }))),
  };
}

/** Returns a name that begins with a capital: words for prompts are written small. */
function capital(name: string, language: string): string {
  const [first = ""] = name;
  return first.toLocaleUpperCase(language) + name.slice(first.length);
}
