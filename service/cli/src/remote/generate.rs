//! `d3dgen generate` of a server: the same folders as if the worlds had been made here.

use std::io::Read;
use std::time::Instant;

use d3dgen_model::report::Report;
use d3dgen_model::robot_body::RobotBody;
use d3dgen_model::world::World;
use d3dgen_pipeline::generate::Generated;
use d3dgen_pipeline::scene_graph::Request;
use d3dgen_proto::v1::generate_world_request::Start;
use d3dgen_proto::v1::generate_world_response::Event;
use d3dgen_proto::v1::world_service_client::WorldServiceClient;
use d3dgen_proto::v1::{self, BuildingRequest, ExportWorldRequest, GenerateWorldRequest};
use tonic::transport::Channel;
use tonic::{Code, Status};

use super::{MESSAGE_BYTES, Remote, document, refused};
use crate::error::Error;
use crate::interrupt;
use crate::output::Output;
use crate::progress::Progress;

/// The largest file of a world that is taken, bytes.
const FILE_BYTES: u64 = 1 << 30;

fn client(remote: &Remote) -> WorldServiceClient<Channel> {
    WorldServiceClient::new(remote.channel())
        .max_decoding_message_size(MESSAGE_BYTES)
        .max_encoding_message_size(MESSAGE_BYTES)
}

/// What all worlds of a run share.
pub struct Maker<'a> {
    /// The server.
    pub remote: &'a Remote,
    /// Formats to write.
    pub formats: &'a [&'static str],
    /// Whether plans are drawn as PNG too.
    pub png: bool,
    /// Builds what contradicts itself too.
    pub allow_conflicts: bool,
}

impl Maker<'_> {
    /// Has a world made and writes its folder; of an unsound one only the report and the documents of the stages.
    ///
    /// # Errors
    /// `Remote`, `Interrupted`, `Write`.
    pub fn make(
        &self,
        request: &Request,
        name: Option<&str>,
        output: &Output,
        progress: &Progress,
    ) -> Result<Generated, Error> {
        interrupt::listen();
        let begun = Instant::now();
        let made = self.remote.wait(async {
            tokio::select! {
                made = self.stages(request, name, progress) => made,
                () = interrupted() => Err(Error::Interrupted),
            }
        })?;
        progress.done(&format!("the world is here ({:.0} ms)", begun.elapsed().as_secs_f64() * 1000.0));
        let Generated { world, report, .. } = &made;
        crate::bundle::write_documents(world, report, output)?;
        if report.is_writable() {
            progress.doing("files");
            self.remote.wait(async {
                tokio::select! {
                    written = self.files(world, output) => written,
                    () = interrupted() => Err(Error::Interrupted),
                }
            })?;
        }
        Ok(made)
    }

    async fn stages(&self, request: &Request, name: Option<&str>, progress: &Progress) -> Result<Generated, Error> {
        let asked = GenerateWorldRequest {
            start: Some(Start::Building(building(request)?)),
            name: name.map(str::to_owned),
            allow_conflicts: self.allow_conflicts,
            ..Default::default()
        };
        let mut client = client(self.remote);
        let answer = client.generate_world(self.remote.request(asked)).await;
        let mut events = answer.map_err(unmade)?.into_inner();
        while let Some(news) = events.message().await.map_err(unmade)? {
            if let Some(now) = &news.progress {
                progress.doing(&format!("{:.0} %: {}", now.fraction * 100.0, now.message));
            }
            match news.event {
                Some(Event::World(checked)) => {
                    let (world, report): (World, Report) = (document(checked.world)?, document(checked.report)?);
                    return Ok(Generated { world, report, attempts: news.attempt + 1 });
                }
                Some(Event::Rejected(reason)) => progress.done(&format!("attempt {}: {reason}", news.attempt + 1)),
                _ => {}
            }
        }
        Err(Error::Remote("the server ended the stream before the world was there".into()))
    }

    async fn files(&self, world: &World, output: &Output) -> Result<(), Error> {
        let message = d3dgen_proto::convert::to_proto(world).map_err(|e| Error::Remote(e.to_string()))?;
        let formats = self.formats.iter().map(|f| (*f).to_owned()).collect();
        let asked = ExportWorldRequest { world: Some(message), formats };
        let mut client = client(self.remote);
        let answer = client.export_world(self.remote.request(asked)).await;
        let (mut pieces, mut archive) = (answer.map_err(refused)?.into_inner(), Vec::new());
        while let Some(piece) = pieces.message().await.map_err(refused)? {
            archive.extend(piece.chunk);
        }
        self.unpack(archive, output)
    }

    fn unpack(&self, archive: Vec<u8>, output: &Output) -> Result<(), Error> {
        let broken = |e: &dyn std::fmt::Display| Error::Remote(format!("the archive cannot be read: {e}"));
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(archive)).map_err(|e| broken(&e))?;
        for at in 0..archive.len() {
            let file = archive.by_index(at).map_err(|e| broken(&e))?;
            // a server is not trusted with the rest of the disk
            let inside = file.enclosed_name().and_then(|p| p.to_str().map(str::to_owned));
            let Some(path) = inside else { return Err(broken(&format!("`{}` leads out of it", file.name()))) };
            if file.is_dir() || (path == "plan.png" && !self.png) {
                continue;
            }
            let mut bytes = Vec::new();
            file.take(FILE_BYTES).read_to_end(&mut bytes).map_err(|e| broken(&e))?;
            output.write(&path, &bytes)?;
        }
        Ok(())
    }
}

fn building(request: &Request) -> Result<BuildingRequest, Error> {
    let brief = request.brief.as_ref().map(d3dgen_proto::convert::to_proto).transpose();
    Ok(BuildingRequest {
        prompt: request.prompt.clone(),
        brief: brief.map_err(|e| Error::Remote(e.to_string()))?,
        seed: request.seed,
        domain_id: request.domain.clone(),
        country: request.country.clone(),
        room_count: request.rooms,
        floor_area_m2: request.area_m2,
        robot_radius_m: request.robot_radius_m,
        clutter: request.style.clutter.map(|c| c.name().to_owned()),
        robot: (request.robot != RobotBody::default()).then_some(v1::RobotBody {
            width_m: request.robot.width_m,
            length_m: request.robot.length_m,
            height_m: request.robot.height_m,
            turning_radius_m: request.robot.turning_radius_m,
            climb_m: request.robot.climb_m,
            fit: request.robot.fit,
        }),
        styles: request.style.words().map(str::to_owned).collect(),
    })
}

/// Returns why no world was made: for some seeds there is none, which is no reason to leave out the others.
fn unmade(status: Status) -> Error {
    if status.code() != Code::FailedPrecondition {
        return refused(status);
    }
    let message = status.message().rsplit(": no solution found: ").next().unwrap_or_default().to_owned();
    Error::Stage(d3dgen_pipeline::Error::Infeasible { stage: "server", message })
}

/// Waits until the user asks to stop.
async fn interrupted() {
    while interrupt::check().is_ok() {
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    }
}
