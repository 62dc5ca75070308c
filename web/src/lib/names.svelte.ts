/** What kinds of rooms and things are called in the reader's language. */
import { kindsOf } from "./kinds";
import { texts, words } from "./texts.svelte";

class Names {
  #known = $state.raw(new Map<string, string>());

  /** Learns the names of a domain's kinds; ids are English words already. */
  async learn(domainId: string) {
    const language = texts.language;
    const kinds = language === "en" ? { room: [], object: [] } : await kindsOf(domainId);
    if (language === texts.language) this.#known = new Map([...kinds.room, ...kinds.object].map(({ id, name }) => [id, name]));
  }

  /** Returns the name of a kind of room or thing; its id in words until it is known. */
  of(id: string): string {
    return this.#known.get(id) ?? words(id);
  }
}

export const names = new Names();
