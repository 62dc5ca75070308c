/** The words of the page, in the language of the reader: data in `texts/`, one file a language. */
import de from "../texts/de.json";
import en from "../texts/en.json";

export type TextKey = keyof typeof en;

const LANGUAGES: Record<string, Record<TextKey, string>> = { en, de };
const REMEMBERED = "d3dgen.language";

export const languages = Object.keys(LANGUAGES);

function first(): string {
  const wished = [localStorage.getItem(REMEMBERED), ...navigator.languages.map((l) => l.slice(0, 2))];
  return wished.find((l): l is string => l !== null && l in LANGUAGES) ?? "en";
}

class Texts {
  language = $state(first());

  /** Takes another language, and remembers it. */
  use(language: string) {
    this.language = language;
    localStorage.setItem(REMEMBERED, language);
    document.documentElement.lang = language;
  }
}

export const texts = new Texts();
document.documentElement.lang = texts.language;

/** Returns a text with its `{places}` filled. */
export function t(key: TextKey, values: Record<string, string | number> = {}): string {
  const text = (LANGUAGES[texts.language] ?? en)[key];
  return text.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}

/** Returns the text of a key that is made of data, and `or` where there is none for it. */
export function told(key: string, or: string, values: Record<string, string | number> = {}): string {
  return key in en ? t(key as TextKey, values) : or;
}

/** Returns a figure as the reader's language writes it, with at most `digits` behind the point. */
export function figure(value: number, digits = 2): string {
  return value.toLocaleString(texts.language, { maximumFractionDigits: digits });
}

/** Returns about how long so many seconds are. */
export function duration(seconds: number): string {
  if (seconds < 100) return t("duration.s", { n: figure(seconds, 0) });
  if (seconds < 6000) return t("duration.min", { n: figure(seconds / 60, 0) });
  return t("duration.h", { n: figure(seconds / 3600, 1) });
}

/** Returns an id or open word as people read it: `patient_room` becomes `patient room`. */
export function words(id: string): string {
  return id.replaceAll("_", " ");
}

/** Returns a unit as people write it: `m^2` becomes `m²`; nothing for plain numbers. */
export function unitSaid(unit: string): string {
  if (unit === "count") return "";
  return unit.replace("^2", "²").replace("^3", "³").replace(/^deg$/, "°");
}

/** Returns the name of a storey. */
export function levelName(level: number): string {
  if (level === 0) return t("level.ground");
  return level > 0 ? t("level.upper", { level }) : t("level.basement", { level: -level });
}
