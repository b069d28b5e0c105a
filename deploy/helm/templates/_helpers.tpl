{{- define "curvecast.name" -}}
{{- default .Chart.Name .Values.nameOverride | trunc 40 | trimSuffix "-" }}
{{- end }}

{{/* Short enough for what is appended, and for the number of a pod. */}}
{{- define "curvecast.fullname" -}}
{{- $name := include "curvecast.name" . }}
{{- if .Values.fullnameOverride }}
{{- .Values.fullnameOverride | trunc 40 | trimSuffix "-" }}
{{- else if contains $name .Release.Name }}
{{- .Release.Name | trunc 40 | trimSuffix "-" }}
{{- else }}
{{- printf "%s-%s" .Release.Name $name | trunc 40 | trimSuffix "-" }}
{{- end }}
{{- end }}

{{/* Takes (list . COMPONENT). */}}
{{- define "curvecast.selector" -}}
app.kubernetes.io/name: {{ include "curvecast.name" (first .) }}
app.kubernetes.io/instance: {{ (first .).Release.Name }}
app.kubernetes.io/component: {{ last . }}
{{- end }}

{{- define "curvecast.labels" -}}
{{ include "curvecast.selector" . }}
app.kubernetes.io/version: {{ (first .).Chart.AppVersion | quote }}
app.kubernetes.io/managed-by: {{ (first .).Release.Service }}
helm.sh/chart: {{ printf "%s-%s" (first .).Chart.Name (first .).Chart.Version | replace "+" "_" }}
{{- end }}

{{/* The most servers that there may be. */}}
{{- define "curvecast.replicas" -}}
{{- if .Values.autoscaling.enabled }}{{ .Values.autoscaling.maxReplicas }}{{ else }}{{ .Values.replicas }}{{ end }}
{{- end }}

{{- define "curvecast.tokensSecret" -}}
{{- if .Values.tokens.secret }}{{ .Values.tokens.secret }}
{{- else if .Values.tokens.lines }}{{ include "curvecast.fullname" . }}-tokens
{{- end }}
{{- end }}

{{/* The certificate is shown by who meets the clients. */}}
{{- define "curvecast.serverTls" -}}
{{- if and .Values.tls.secret (not .Values.gateway.enabled) }}true{{ end }}
{{- end }}

{{- define "curvecast.gatewayTls" -}}
{{- if and .Values.tls.secret .Values.gateway.enabled }}true{{ end }}
{{- end }}

{{/* Of a pod, servers' or gateway's: (list . COMPONENT). */}}
{{- define "curvecast.pod" -}}
{{- $values := (first .).Values -}}
automountServiceAccountToken: false
enableServiceLinks: false # else a Service named curvecast becomes CURVECAST_... settings
{{- with $values.serviceAccountName }}
serviceAccountName: {{ . }}
{{- end }}
{{- with $values.imagePullSecrets }}
imagePullSecrets:
  {{- range . }}
  - name: {{ . }}
  {{- end }}
{{- end }}
{{- with $values.priorityClassName }}
priorityClassName: {{ . }}
{{- end }}
{{- with $values.nodeSelector }}
nodeSelector:
  {{- toYaml . | nindent 2 }}
{{- end }}
{{- with $values.tolerations }}
tolerations:
  {{- toYaml . | nindent 2 }}
{{- end }}
{{- with $values.affinity }}
affinity:
  {{- toYaml . | nindent 2 }}
{{- end }}
securityContext:
  runAsNonRoot: true
  runAsUser: 65532
  runAsGroup: 65532
  fsGroup: 65532
  fsGroupChangePolicy: OnRootMismatch
  seccompProfile:
    type: RuntimeDefault
{{- if $values.topologySpread.enabled }}
{{- $all := . }}
topologySpreadConstraints:
  {{- range $values.topologySpread.keys }}
  - maxSkew: 1
    topologyKey: {{ . }}
    whenUnsatisfiable: {{ $values.topologySpread.whenUnsatisfiable }}
    labelSelector:
      matchLabels:
        {{- include "curvecast.selector" $all | nindent 8 }}
  {{- end }}
{{- end }}
{{- end }}

{{- define "curvecast.container" -}}
securityContext:
  allowPrivilegeEscalation: false
  readOnlyRootFilesystem: true
  capabilities:
    drop: [ALL]
{{- end }}

{{/* Several values stand in a variable with semicolons between them. */}}
{{- define "curvecast.setting" -}}
{{- if kindIs "slice" . }}{{ join ";" . }}{{ else if kindIs "float64" . }}{{ if eq (floor .) . }}{{ int64 . }}{{ else }}{{ . }}{{ end }}{{ else }}{{ . }}{{ end }}
{{- end }}

{{/* What no schema can say. */}}
{{- define "curvecast.shared" -}}
{{- if or .Values.cache.sharedClaim .Values.store.url }}true{{ end }}
{{- end }}

{{- define "curvecast.check" -}}
{{- $values := .Values }}
{{- if not (or $values.tokens.secret $values.tokens.lines $values.tls.clientCaSecret $values.openToAll) }}
{{- fail "who may call? Set tokens.secret, tokens.lines, tls.clientCaSecret, or openToAll=true for everybody" }}
{{- end }}
{{- if and $values.openToAll (or $values.tokens.secret $values.tokens.lines $values.tls.clientCaSecret) }}
{{- fail "openToAll=true together with tokens or tls.clientCaSecret: which of them?" }}
{{- end }}
{{- if and $values.tokens.secret $values.tokens.lines }}
{{- fail "tokens.secret and tokens.lines: one of them" }}
{{- end }}
{{- if and $values.tls.clientCaSecret $values.gateway.enabled }}
{{- fail "tls.clientCaSecret needs gateway.enabled=false: behind the gateway servers do not see the certificates of clients" }}
{{- end }}
{{- if and $values.tls.clientCaSecret (not $values.tls.secret) }}
{{- fail "tls.clientCaSecret needs tls.secret, the servers' own certificate" }}
{{- end }}
{{- if and $values.autoscaling.enabled (not (include "curvecast.shared" .)) }}
{{- fail "autoscaling.enabled needs store.url or cache.sharedClaim: sessions that go to another server have to be found there" }}
{{- end }}
{{- if and $values.store.url $values.cache.sharedClaim }}
{{- fail "store.url together with cache.sharedClaim: behind a store each server has a cache of its own" }}
{{- end }}
{{- if ne (eq $values.store.url "file:///store") (ne $values.store.claim "") }}
{{- fail "store.claim and store.url=file:///store need each other: the claim is mounted there" }}
{{- end }}
{{- if and (or $values.store.secret $values.store.environment $values.store.egress) (not (hasPrefix "s3://" $values.store.url)) }}
{{- fail "store.secret, store.environment and store.egress are for a store.url of s3://BUCKET/PREFIX" }}
{{- end }}
{{- if and $values.autoscaling.enabled (gt (int $values.autoscaling.minReplicas) (int $values.autoscaling.maxReplicas)) }}
{{- fail "autoscaling.minReplicas is more than autoscaling.maxReplicas" }}
{{- end }}
{{- if and $values.autoscaling.enabled (not $values.autoscaling.cpu) (not $values.autoscaling.viewWait.enabled) }}
{{- fail "autoscaling by what? autoscaling.cpu, autoscaling.viewWait.enabled, or both" }}
{{- end }}
{{- if and $values.gateway.enabled (hasKey $values.settings "trusted-proxy") }}
{{- fail "settings.trusted-proxy is for proxies of your own, with gateway.enabled=false; else gateway.trustedNetworks" }}
{{- end }}
{{- end }}
