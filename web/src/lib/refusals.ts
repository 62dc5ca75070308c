/** What the server refuses, in the reader's words: by the reasons that it gives, which stay as they are. */
import { Code, ConnectError } from "@connectrpc/connect";

import type { World } from "../gen/d3dgen/v1/world_pb";
import { names } from "./names.svelte";
import { type Facts, placesOf, reasonIn } from "./problems";
import { t } from "./texts.svelte";
import { nameOf } from "./world";

export function codeOf(error: unknown): Code {
  return ConnectError.from(error).code;
}

/** Returns true for what a person can do something about: no edit keeps the rules, a wish that contradicts itself. */
export function isRefusal(error: unknown): boolean {
  return [Code.FailedPrecondition, Code.InvalidArgument].includes(codeOf(error));
}

/** What the page says by the reason; `world` is the one at hand, which knows what things are called. */
const SAID: Record<string, (facts: Facts, world: World | undefined) => string> = {
  BREAKS_RULE: ({ rule = "", subject = "" }, world) =>
    t("refused.breaks", { where: nameOf(world, subject), rule: names.rule(rule, titles.get(rule)) }),
  CONTRADICTS_ITSELF: ({ conflicts = "" }) => t("refused.contradicts", { conflicts }),
  DISK_FULL: () => t("refused.full"),
  NOT_SOUND: ({ rule = "" }) => t("refused.unsound", { rule: names.rule(rule, titles.get(rule)) }),
  SCOPE_TOO_SMALL: () => t("refused.scope"),
  TOO_MUCH_AT_ONCE: () => t("refused.busy"),
  UNKNOWN_BUILDING: ({ name = "", nearest = "" }) => t("refused.unknownBuilding", { name, nearest }),
};
const NO_SOLUTION = "NO_SOLUTION";
/** How the server begins to say that there is none. */
const VAIN = "no solution found: ";

/** Titles of hard rules by their ids, in English, as the last verdict had them. */
const titles = new Map<string, string>();

/** Remembers what hard rules demand, for refusals that name one. */
export function learnTitles(rules: { rule: string; title: string }[]) {
  for (const { rule, title } of rules) titles.set(rule, title);
}

/** Returns what went wrong: in the page's words where the server gives a reason for that, else in the server's own. */
export function reasonOf(error: unknown, world?: World): string {
  const known = ConnectError.from(error);
  const { reason, facts } = reasonIn(error);
  const own = SAID[reason]?.(facts, world);
  if (own) return own;
  const places = placesOf(error).map((place) => place.message);
  const said = places.length > 0 ? places : [known.rawMessage || Code[known.code]];
  const detail = said.map((text) => names.sentence(without(without(text, facts.stage && `${facts.stage}: `), VAIN))).join("\n");
  return reason === NO_SOLUTION ? t("refused.noSolution", { detail }) : detail;
}

function without(text: string, beginning: string | undefined): string {
  return beginning && text.startsWith(beginning) ? text.slice(beginning.length) : text;
}
