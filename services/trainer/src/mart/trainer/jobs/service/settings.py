"""Settings of the trainer service; each is an option and an environment variable."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from mart.runtime.settings import Settings
from mart.trainer.jobs.service.data_folders import DataFolders


class TrainerSettings(Settings):
    """Settings of `mart trainer`."""

    trainer: str = Field("trainer-1", description="Id of the trainer service.")
    slots: int = Field(1, ge=1, le=256, description="Jobs at a time on this machine.")
    ray: str = Field("", description="Address of the head of a Ray cluster, like 10.0.0.5:6379.")
    replicas: str = Field("", description="Running replicas to judge on; default: each job starts one.")
    device: str = Field("cpu", description="What trains: cpu or cuda.")
    data_folders: str = Field(
        "", description="Folders outside the data folder that trainings may learn from, separated by commas."
    )

    @property
    def jobs_path(self) -> Path:
        """Tell where the job table is."""
        return self.data_dir / "jobs.sqlite"

    @property
    def policies_dir(self) -> Path:
        """Promoted policies, one folder each, by name."""
        return self.data_dir / "policies"

    @property
    def allowed_folders(self) -> DataFolders:
        """The folders that trainings may learn from."""
        return DataFolders(self.data_dir, map(Path, filter(None, self.data_folders.split(","))))

    @property
    def replica_names(self) -> tuple[str, ...]:
        """Names of the replicas that jobs evaluate on; empty: each job starts one."""
        return tuple(name for name in self.replicas.split(",") if name)
