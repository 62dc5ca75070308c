/** The token of the server, where it wants one: asked of the person, kept in memory only. */
class Access {
  token = $state("");
  /** True while the page waits for a token. */
  asking = $state(false);
  /** True when the last token was refused. */
  wrong = $state(false);
  #waiting: (() => void)[] = [];

  /** Waits until there is another token than the one that was refused. */
  ask(refused: string): Promise<void> {
    if (this.token !== refused) return Promise.resolve();
    this.asking = true;
    this.wrong = refused !== "";
    return new Promise((go) => this.#waiting.push(go));
  }

  /** Takes the token that the person gave; calls that wait go on. */
  give(token: string) {
    this.token = token.trim();
    this.asking = false;
    for (const go of this.#waiting.splice(0)) go();
  }
}

export const access = new Access();
