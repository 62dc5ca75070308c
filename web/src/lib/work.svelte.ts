/** Work that a part of the page waits for: what goes wrong is said, and nothing else is begun meanwhile. */
import { reasonOf } from "./refusals";
import { session } from "./session.svelte";

export class Work {
  busy = $state(false);

  /** Does something; returns true when it went well. */
  async run(what: () => Promise<unknown>): Promise<boolean> {
    this.busy = true;
    try {
      await what();
      return true;
    } catch (error) {
      session.say(reasonOf(error));
      return false;
    } finally {
      this.busy = false;
    }
  }
}
