//! `AdminService`.

use d3dgen_proto::v1::admin_service_server::AdminService;
use d3dgen_proto::v1::{CreateBackupRequest, CreateBackupResponse};
use tonic::Request;

use super::{Answer, Api};
use crate::backup;

#[tonic::async_trait]
impl AdminService for Api {
    async fn create_backup(&self, _: Request<CreateBackupRequest>) -> Answer<CreateBackupResponse> {
        self.work(move |core, stop| {
            let made = backup::write(core, stop)?;
            let name = made.folder.file_name().unwrap_or_default();
            Ok(CreateBackupResponse {
                backup_name: name.to_string_lossy().into_owned(),
                record_count: made.records,
                file_count: made.files,
            })
        })
        .await
    }
}
