// What the HTTP API tells of recorded episodes, and takes of what people say about them (docs/protocol.md).

import { ApiError, request, sceneNamed } from "../api.js";

const encoded = encodeURIComponent;

/** @typedef {Promise<{ curated: Messages.CatalogueReplyCurated }>} CurationAnswer */

/** @type {(path: string, part?: string) => string} */
const episodePath = (path, part = "") => `/episode${part}?${new URLSearchParams({ path })}`;

/** @type {(dataset: string) => string} */
const datasetPath = (dataset) => `/datasets/${encoded(dataset)}`;

/**
 * `count` of the episodes that a query lets through; null where no catalogue runs.
 * @type {(query: URLSearchParams, count: number) => Promise<{ listing: Api.EpisodeListing | null }>}
 */
export const episodes = (query, count) =>
  request("GET", `/episodes?${new URLSearchParams([...query, ["count", String(count)]])}`);

/** One episode in full. @type {(path: string) => Promise<{ details: Api.EpisodeDetails }>} */
export const episode = (path) => request("GET", episodePath(path));

/** How well one episode was. @type {(path: string) => Promise<{ quality: Messages.CatalogueReplyQualityDetails }>} */
export const episodeQuality = (path) => request("GET", episodePath(path, "/quality"));

/**
 * How well the episodes of a task were, by operator or by day.
 * @type {(task: string, by: string) => Promise<{ comparison: Api.QualityComparison }>}
 */
export const comparedQuality = (task, by) => request("GET", `/episodes/quality?${new URLSearchParams({ task, by })}`);

/**
 * Says something about an episode; what is absent stays as it is.
 * @type {(path: string, labels: Api.EpisodeLabels) => Promise<{ episode: Api.Episode }>}
 */
export const labelEpisode = (path, labels) => request("POST", episodePath(path), labels);

/** @typedef {Promise<{ edited: Api.EditedEpisode }>} EditAnswer */

/** How an episode is edited now. @type {(path: string) => EditAnswer} */
export const episodeEdits = (path) => request("GET", episodePath(path, "/edits"));

/** Edits an episode, in one act. @type {(path: string, edits: Api.EpisodeEditing) => EditAnswer} */
export const editEpisode = (path, edits) => request("POST", episodePath(path, "/edits"), edits);

/** Takes back one act; 0: the newest. @type {(path: string, actNs: string) => EditAnswer} */
export const undoEdit = (path, actNs) => request("POST", episodePath(path, "/edits/undo"), { act_ns: actNs });

/**
 * Puts episodes into a data set, or takes them out of it.
 * @type {(dataset: string, curation: Api.Curation) => CurationAnswer}
 */
export const curate = (dataset, curation) => request("POST", datasetPath(dataset), curation);

/** Takes back what was done at `actNs`. @type {(dataset: string, actNs: string) => CurationAnswer} */
export const undoCuration = (dataset, actNs) => request("POST", `${datasetPath(dataset)}/undo`, { act_ns: actNs });

/** The address of an episode file. @type {(path: string) => string} */
export const fileOf = (path) => `/api${episodePath(path, "/file")}`;

/** The scene that an episode was recorded in. @param {string} path */
export const episodeScene = async (path) => sceneNamed(await request("GET", episodePath(path, "/scene")));

/**
 * Where an episode's bodies are in every tick.
 * @param {string} path
 * @param {boolean} simulated its seconds are, else the wall's
 */
export async function episodeMotion(path, simulated) {
  const response = await fetch(`/api${episodePath(path, "/motion")}&simulated=${simulated}`);
  if (response.ok) return response.arrayBuffer();
  const { error } = await response.json().catch(() => ({}));
  throw new ApiError(response.status, "", error?.message ?? "The episode's motion could not be had; try again.");
}

/** The address of an episode's last recorded picture. @type {(path: string) => string} */
export const pictureOf = (path) => `/api${episodePath(path, "/picture")}`;

/** The address of what one camera saw, recorded or drawn. @type {(path: string, camera: string) => string} */
export const episodeVideoOf = (path, camera) => `/api${episodePath(path, "/video")}&camera=${encoded(camera)}`;
