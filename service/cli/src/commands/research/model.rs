//! The language model of a research run: how it is asked, and the user's consent.

use std::io::{self, BufRead, IsTerminal, Write};

use d3dgen_llm::Estimate;

use crate::commands::LlmArgs;

/// Flags of the model.
#[derive(clap::Args)]
pub struct ModelArgs {
    #[command(flatten)]
    pub llm: LlmArgs,
    /// Passes of each of the eight topics; each looks at other kinds of source
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=20))]
    pub passes: u32,
    /// Requests on their way at a time
    #[arg(long, value_name = "N", default_value = "2", value_parser = parallel)]
    pub parallel: usize,
    /// Searches of one request that are budgeted for
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub max_searches: u32,
    /// Begin without asking
    #[arg(long)]
    pub yes: bool,
    /// State that your agreement with Google allows to store grounded results and build a database from them
    #[arg(long)]
    pub accept_grounding_terms: bool,
}

fn parallel(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|n| (1..=8).contains(n));
    count.ok_or_else(|| "1 to 8 requests can be on their way".into())
}

/// Says what a run may need at most, and asks whether to begin. `--yes` and a budget are a yes.
pub fn confirm(estimate: &Estimate, args: &ModelArgs) -> bool {
    let cost = estimate.cost.map_or_else(|| "cost unknown without --price".to_owned(), |c| format!("{c:.2} USD"));
    eprintln!(
        "at most {} requests, {} tokens in, {} tokens out, {} searches, {cost}; retries aside",
        estimate.calls, estimate.usage.input, estimate.usage.output, estimate.usage.searches
    );
    let limited = args.llm.budget_tokens.is_some() || args.llm.budget_usd.is_some();
    if limited && !estimate.fits {
        eprintln!("that may not fit the budget: the run ends with what it has when the next request would not fit");
    }
    if args.yes || limited {
        return true;
    }
    if !io::stdin().is_terminal() {
        eprintln!("say --yes, or set a limit with --budget-tokens or --budget-usd");
        return false;
    }
    eprint!("begin? [y/N] ");
    let mut line = String::new();
    let answered = io::stderr().flush().is_ok() && io::stdin().lock().read_line(&mut line).is_ok();
    answered && matches!(line.trim().to_lowercase().as_str(), "y" | "yes")
}
