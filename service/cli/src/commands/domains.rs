//! `d3dgen domains`: the kinds of building there are.

use std::path::PathBuf;

use clap::Subcommand;
use d3dgen_model::domain::Domain;
use d3dgen_plugins::{Custom, Plugin};

use crate::error::Error;
use crate::input::write_text;
use crate::registry::{RegistryArgs, domain, domain_folders};
use crate::remote::{self, ServerArgs};
use crate::table::table;

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    action: Action,
}

#[derive(Subcommand)]
enum Action {
    /// One line for each domain
    List {
        /// Print one JSON line for each domain
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        registry: RegistryArgs,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Rooms, programs and objects of one domain
    Show {
        /// Id of the domain
        id: String,
        /// Print the whole domain as JSON
        #[arg(long)]
        json: bool,
        #[command(flatten)]
        registry: RegistryArgs,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Register the domain of a folder with a server (--server), with effect at once
    Register {
        /// Folder of the domain
        #[arg(value_name = "DIR")]
        dir: PathBuf,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Remove a domain that was registered with a server (--server)
    Remove {
        /// Id of the domain
        id: String,
        #[command(flatten)]
        server: ServerArgs,
    },
    /// Read domain folders and report every problem
    Validate {
        /// Folder of a domain, or of several
        #[arg(value_name = "DIR", required = true)]
        dirs: Vec<PathBuf>,
    },
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        match self.action {
            Action::List { json, registry, server } => match server.instead_of(&registry)? {
                Some(remote) => {
                    let all = remote::domains::list(&remote)?;
                    let row = |(listed, domain): &(_, Domain)| Row::of_server(listed, domain);
                    list(all.iter().map(row).collect(), json)
                }
                None => list(registry.load()?.iter().map(Row::of).collect(), json),
            },
            Action::Show { id, json, registry, server } => {
                if let Some(remote) = server.instead_of(&registry)? {
                    let domain = remote::domains::manifest(&remote, &id)?;
                    let text = if json { d3dgen_model::Document::to_json(&domain) } else { shown(&domain) };
                    return write_text(None, &text);
                }
                let registry = registry.load()?;
                let domain = domain(&registry, &id)?.domain();
                write_text(None, &if json { d3dgen_model::Document::to_json(domain) } else { shown(domain) })
            }
            Action::Register { dir, server } => {
                let kept = remote::domains::register(&server.required()?, &dir)?;
                write_text(None, &format!("{}: registered, version {}\n", kept.domain_id, kept.domain_version))
            }
            Action::Remove { id, server } => {
                remote::domains::remove(&server.required()?, &id)?;
                write_text(None, &format!("{id}: removed\n"))
            }
            Action::Validate { dirs } => validate(&dirs),
        }
    }
}

fn figures(plugin: &dyn Plugin) -> [usize; 4] {
    let (domain, knowledge) = (plugin.domain(), plugin.knowledge());
    let constraints = knowledge.references.iter().map(|r| r.constraints.len()).sum();
    [domain.room_types.len(), domain.programs.len(), domain.objects.len(), constraints]
}

/// A domain in a list.
struct Row {
    id: String,
    title: String,
    description: String,
    figures: [usize; 4],
}

impl Row {
    fn of(plugin: &dyn Plugin) -> Self {
        let domain = plugin.domain();
        let (id, title, description) = (domain.id.clone(), domain.title.clone(), domain.description.clone());
        Self { id, title, description, figures: figures(plugin) }
    }

    fn of_server(listed: &d3dgen_proto::v1::Domain, domain: &Domain) -> Self {
        let (id, title, description) = (domain.id.clone(), domain.title.clone(), domain.description.clone());
        let figures = [
            domain.room_types.len(),
            domain.programs.len(),
            domain.objects.len(),
            usize::try_from(listed.constraint_count).unwrap_or(usize::MAX),
        ];
        Self { id, title, description, figures }
    }
}

fn list(domains: Vec<Row>, json: bool) -> Result<(), Error> {
    let mut text = String::new();
    let mut rows = Vec::new();
    for Row { id, title, description, figures } in domains {
        let [room_types, programs, objects, constraints] = figures;
        let line = serde_json::json!({
            "id": id, "title": title, "description": description, "room_types": room_types, "programs": programs,
            "objects": objects, "constraints": constraints,
        });
        text += &format!("{line}\n");
        rows.push([vec![id], figures.map(|n| n.to_string()).to_vec(), vec![description]].concat());
    }
    let header = ["domain", "room types", "programs", "objects", "constraints", ""];
    write_text(None, &if json { text } else { table(&header, &rows) })
}

fn shown(domain: &Domain) -> String {
    let rooms = domain.room_types.iter().map(|t| {
        let a = t.area_m2;
        let furniture: Vec<&str> = t.furnishing.iter().filter(|f| f.required).map(|f| f.item.as_str()).collect();
        vec![t.id.clone(), a.min.to_string(), a.target.to_string(), a.max.to_string(), furniture.join(", ")]
    });
    let programs = domain.programs.iter().map(|p| {
        let rooms: Vec<String> = p.rooms.iter().map(|r| format!("{} {}-{}", r.room_type, r.min, r.max)).collect();
        vec![p.id.clone(), p.default_rooms.to_string(), rooms.join(", ")]
    });
    format!(
        "{}: {}\n{}\n\n{}\n{}",
        domain.id,
        domain.title,
        domain.description,
        table(&["room type", "min m2", "usual", "max", "always has"], &rooms.collect::<Vec<_>>()),
        table(&["program", "rooms", "from - to"], &programs.collect::<Vec<_>>()),
    )
}

fn validate(dirs: &[PathBuf]) -> Result<(), Error> {
    let folders = dirs.iter().map(|d| domain_folders(d)).collect::<Result<Vec<_>, Error>>()?.concat();
    let mut broken = 0;
    for folder in &folders {
        match Custom::read(folder) {
            Ok(plugin) => {
                // A build can be well formed and yet not hold at a size of its objects.
                let problems = d3dgen_mesh::builds::problems(plugin.domain());
                if !problems.is_empty() {
                    broken += 1;
                    let lines: String = problems.iter().map(|p| format!("\n  {p}")).collect();
                    eprintln!("{}: models cannot be made:{lines}", folder.display());
                    continue;
                }
                let [room_types, programs, objects, constraints] = figures(&plugin);
                let found = format!(
                    "{room_types} room types, {programs} programs, {objects} objects, {constraints} constraints"
                );
                write_text(None, &format!("{}: valid; {found}\n", folder.display()))?;
            }
            Err(error) => {
                broken += 1;
                eprintln!("{error}");
            }
        }
    }
    match broken {
        0 => Ok(()),
        n => Err(Error::Input(format!("{n} of {} domains cannot be used", folders.len()))),
    }
}
