/**
 * What the server's English sentences say, in the reader's language: patterns as data in `texts/sentences/`, one file a language.
 * What stands in braces is named by what it is: numbers, rooms or things (in a list), words in quotes, a place, anything else.
 */

/** Says what stands in the place of a pattern in the reader's language. */
export interface Speaker {
  /** A number. */
  figure: (value: number) => string;
  /** A room or thing by its English name. */
  named: (name: string) => string;
  /** Several, of which the last `more` are not named. */
  listed: (names: string[], more: number) => string;
  /** Words that a person wrote. */
  quoted: (words: string) => string;
}

interface Pattern {
  match: RegExp;
  places: string[];
  said: string;
}

export type Patterns = Pattern[];

const PLACE = /\{(([a-z]+)\d*)\}/g;
const QUOTED = "(?:`[^`]*`|, | and | or )+";
const NAMES = "[^;]+?";
const PLACES = "there|(?:on|in) (?:the|level|basement|storey) [^;,]+?";
const MATCHES: Record<string, string> = { n: "-?[\\d.]+", quoted: QUOTED, rule: "[a-z0-9_]+", rooms: NAMES, things: NAMES, where: PLACES };
/** What joins the parts of a sentence that is made of several. */
const JOINT = "; ";

/** Returns patterns ready for use, those that say most themselves first. */
export function compiled(table: Record<string, string>): Patterns {
  const own = (text: string) => text.replace(PLACE, "").length;
  return Object.entries(table)
    .sort(([a], [b]) => own(b) - own(a))
    .map(([english, said]) => {
      const places: string[] = [];
      const escaped = english.replace(/[.*+?^$()|[\]\\]/g, "\\$&");
      const source = escaped.replace(PLACE, (_, place: string, kind: string) => {
        places.push(place);
        return `(${MATCHES[kind] ?? ".+?"})`;
      });
      return { match: new RegExp(`^${source}$`), places, said };
    });
}

/** Returns a sentence in the reader's language; nothing where no pattern fits all of it. */
export function inWords(text: string, patterns: Patterns, speaker: Speaker): string | undefined {
  const parts = text.split(JOINT);
  // the longest beginning that a pattern fits, then the rest
  for (let length = parts.length; length > 0; length--) {
    const said = whole(parts.slice(0, length).join(JOINT), patterns, speaker);
    if (said === undefined) continue;
    const rest = parts.slice(length).join(JOINT);
    if (!rest) return said;
    const more = inWords(rest, patterns, speaker);
    return more && `${said}${JOINT}${more}`;
  }
  return undefined;
}

function whole(text: string, patterns: Patterns, speaker: Speaker): string | undefined {
  for (const { match, places, said } of patterns) {
    const found = match.exec(text);
    if (!found) continue;
    const values = places.map((place, i) => filled(place, found[i + 1] ?? "", patterns, speaker));
    if (values.includes(undefined)) continue;
    return said.replace(PLACE, (_, place: string) => values[places.indexOf(place)] ?? "");
  }
  return undefined;
}

/** Returns what stands in a place of a pattern; nothing where it is none of what the place is for. */
function filled(place: string, value: string, patterns: Patterns, speaker: Speaker): string | undefined {
  const quotes = (text: string) => text.replace(/`([^`]*)`/g, (_, words: string) => speaker.quoted(words));
  switch (place.replace(/\d+$/, "")) {
    case "n":
      return speaker.figure(Number(value));
    case "where":
      return whole(value, patterns.filter((p) => p.places.every((other) => other.startsWith("n"))), speaker);
    case "building":
    case "rooms":
    case "things":
      return listed(value, speaker);
    case "quoted": {
      const all = [...value.matchAll(/`([^`]*)`/g)].map(([, words = ""]) => speaker.quoted(words));
      return speaker.listed(all, 0);
    }
    default:
      return quotes(value);
  }
}

function listed(value: string, speaker: Speaker): string {
  const more = / and (\d+) more$/.exec(value);
  const names = (more ? value.slice(0, more.index) : value).split(/, | and /);
  const each = names.map((name) => {
    const [, count, rest = name] = /^(\d+) (?:x )?(.+)$/.exec(name) ?? [];
    const said = rest.startsWith("`") ? speaker.quoted(rest.replaceAll("`", "")) : speaker.named(rest);
    return count ? `${count} × ${said}` : said;
  });
  return speaker.listed(each, Number(more?.[1] ?? 0));
}
