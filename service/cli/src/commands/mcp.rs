//! `d3dgen mcp`: the command as tools for agents, over the Model Context Protocol on standard input and output.
//!
//! A tool is a row of data ([`tools`]): a name, what it is for, a schema made of its arguments, and a function. What the
//! tools do is what the commands do; worlds lie in one folder that the server was given.

mod tools;
mod workshop;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use rmcp::model::{
    CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, Implementation, ListToolsResult,
    PaginatedRequestParams, ServerCapabilities, ServerConfig,
};
use rmcp::service::RequestContext;
use rmcp::transport::stdio;
use rmcp::{ErrorData, RoleServer, ServerHandler, ServiceExt};

use crate::error::Error;
use crate::registry::RegistryArgs;
use tools::{Answer, Tool};
use workshop::Workshop;

/// What an agent reads before its first call.
const INSTRUCTIONS: &str = "\
d3dgen makes simulator-ready, robot-ready indoor worlds from a sentence, and checks them against citable building rules. \
`brief` shows what a sentence is understood as; `generate` makes a world and says which wishes are met; `rooms` and \
`objects` give the ids that `edit` needs; `plan` draws it; `check` judges it; `export` writes it for a simulator. A world \
is named by you and lies in a folder of that name. The same prompt and seed give the same world.";

/// Arguments.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of the worlds that agents make, one folder each; made when the first is written
    #[arg(long, value_name = "DIR", default_value = "d3dgen-worlds")]
    out: PathBuf,
    #[command(flatten)]
    registry: RegistryArgs,
}

impl Args {
    pub fn run(self) -> Result<(), Error> {
        let workshop = Workshop::new(self.registry, self.out)?;
        let tools = Server { workshop: Arc::new(workshop), tools: Arc::new(tools::all()) };
        let refused = |e: &dyn std::fmt::Display| Error::Input(format!("the MCP client: {e}"));
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(|e| refused(&e))?;
        runtime.block_on(async {
            let running = tools.serve(stdio()).await.map_err(|e| refused(&e))?;
            running.waiting().await.map_err(|e| refused(&e))?;
            Ok(())
        })
    }
}

/// Answers one client.
struct Server {
    workshop: Arc<Workshop>,
    tools: Arc<Vec<Tool>>,
}

impl ServerHandler for Server {
    fn get_info(&self) -> ServerConfig {
        let mut info = ServerConfig::new(ServerCapabilities::builder().enable_tools().build());
        info.server_info = Implementation::new("d3dgen", env!("CARGO_PKG_VERSION"));
        info.instructions = Some(INSTRUCTIONS.to_owned());
        info
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListToolsResult, ErrorData> {
        Ok(ListToolsResult::with_all_items(self.tools.iter().map(Tool::listed).collect()))
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> Result<CallToolResponse, ErrorData> {
        let Some(index) = self.tools.iter().position(|t| t.name == request.name) else {
            let names: Vec<&str> = self.tools.iter().map(|t| t.name).collect();
            let message = format!("there is no tool `{}`; there are {}", request.name, names.join(", "));
            return Err(ErrorData::invalid_params(message, None));
        };
        let (workshop, tools) = (Arc::clone(&self.workshop), Arc::clone(&self.tools));
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        let arguments = request.arguments.unwrap_or_default();
        let mut work = tokio::task::spawn_blocking(move || tools[index].call(&workshop, arguments, &asked));
        let done = tokio::select! {
            done = &mut work => done,
            () = context.ct.cancelled() => {
                stop.store(true, Ordering::SeqCst);
                work.await
            }
        };
        let answer = done.map_err(|e| ErrorData::internal_error(e.to_string(), None))?;
        Ok(CallToolResponse::from(match answer {
            Ok(answer) => shown(answer),
            Err(error) => CallToolResult::error(vec![ContentBlock::text(error.to_string())]),
        }))
    }
}

/// Returns an answer as content blocks: a text, the same as data, and a picture where there is one.
fn shown(answer: Answer) -> CallToolResult {
    let mut content = vec![ContentBlock::text(answer.text)];
    content.extend(answer.png.map(|png| ContentBlock::image(STANDARD.encode(png), "image/png")));
    let mut result = CallToolResult::success(content);
    result.structured_content = Some(answer.data);
    result
}
