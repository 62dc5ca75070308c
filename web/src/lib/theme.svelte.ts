/** Light or dark: as the system says until the person says otherwise. */
const REMEMBERED = "d3dgen.theme";

class Theme {
  /** True while dark colors are shown. */
  dark = $state(false);

  constructor() {
    const wished = localStorage.getItem(REMEMBERED);
    this.#use(wished ? wished === "dark" : matchMedia("(prefers-color-scheme: dark)").matches);
  }

  #use(dark: boolean) {
    this.dark = dark;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
  }

  /** Takes the other one, and remembers it. */
  turn() {
    this.#use(!this.dark);
    localStorage.setItem(REMEMBERED, this.dark ? "dark" : "light");
  }
}

export const theme = new Theme();
