/** The kinds of room and of thing that a domain knows, by their names in the reader's language; asked for once each. */
import { domains } from "./api";
import { texts } from "./texts.svelte";

export interface Kind {
  id: string;
  name: string;
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
  const { manifest } = await domains.getDomain({ domainId, includeManifest: true });
  const named = (one: Named) => (language === "en" ? one.label : capital(one.keywords[language]?.items[0] ?? one.label, language));
  const sorted = (all: Kind[]) => all.sort((a, b) => a.name.localeCompare(b.name, language));
  return {
    room: sorted((manifest?.roomTypes ?? []).map((r) => ({ id: r.roomTypeId, name: named(r) }))),
    object: sorted((manifest?.objects ?? []).map((o) => ({ id: o.objectId, name: named(o) }))),
  };
}

/** Returns a name that begins with a capital: words for prompts are written small. */
function capital(name: string, language: string): string {
  const [first = ""] = name;
  return first.toLocaleUpperCase(language) + name.slice(first.length);
}
