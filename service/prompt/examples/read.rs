//! Reads prompts, one a line of standard input, and prints what each asks for: the quickest look at the grammar.

use d3dgen_plugins::Registry;
use d3dgen_prompt::PromptReader;

fn main() {
    let reader = PromptReader::new(&Registry::builtin());
    for line in std::io::stdin().lines().map_while(Result::ok) {
        let read = reader.read(&line);
        let brief = &read.brief;
        let building = brief.building.as_ref().map(|b| {
            format!(
                "{}/{} '{}' {}",
                b.domain.as_deref().unwrap_or("-"),
                b.building_type.as_deref().unwrap_or("-"),
                b.name,
                b.confidence
            )
        });
        println!(
            "{line}\n  {} | {} | {}",
            brief.languages.join(" "),
            building.unwrap_or_default(),
            brief.place.as_ref().map_or("", |p| &p.country_code)
        );
        read.facts.iter().zip(&brief.asks).for_each(|(fact, ask)| println!("  {fact}   <- {}", ask.said()));
        brief.not_understood.iter().for_each(|w| println!("  ?? {}", w.text));
        read.misspelled.iter().for_each(|(written, meant)| println!("  ~~ {written} as {meant}"));
        read.unread_language.iter().for_each(|l| println!("  !! {l}"));
        if std::env::args().any(|a| a == "--steps") {
            read.steps.iter().for_each(|s| println!("    {}: {} <- {}", s.file, s.rule, s.words));
        }
    }
}
