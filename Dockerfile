# docker build -t faying . && docker run --rm -v "$PWD:/work" faying run study.toml
FROM python:3.12-slim AS build
COPY pyproject.toml README.md LICENSE /src/
COPY src /src/src
RUN pip wheel --no-deps --wheel-dir /dist /src
FROM python:3.12-slim
RUN apt-get update \
 && apt-get install -y --no-install-recommends libgl1 libglu1-mesa libxrender1 libxext6 libsm6 \
 && rm -rf /var/lib/apt/lists/*
COPY --from=build /dist /dist
RUN pip install --no-cache-dir "$(ls /dist/*.whl)[vtk]"
WORKDIR /work
ENTRYPOINT ["faying"]
